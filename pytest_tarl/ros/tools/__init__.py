"""The Python libraries of ROS 1 command line tools, for nodes that use them: rosgraph, rosnode, rostopic, and more."""
