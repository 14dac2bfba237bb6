"""Models of ROS: sources, sinks, and registrations of callbacks."""
