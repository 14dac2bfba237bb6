"""Models of ROS: sources, sinks and what runs callbacks."""
