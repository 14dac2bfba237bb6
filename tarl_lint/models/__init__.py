"""Models of what is not read: containers, records, strings, futures, ROS."""
