"""Recorded missions: read bags of ROS 1 and ROS 2 with `rosbags`, and replay them to nodes in virtual time."""
