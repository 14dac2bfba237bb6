"""What ROS 1 nodes ask of the command line tools' libraries: rosgraph, rosnode, rostopic, rosservice, rosparam."""
