"""Libraries of the ROS 1 command line tools, as nodes use them: rosgraph, rosnode, rostopic, and more."""
