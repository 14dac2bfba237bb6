"""Recorded missions: bags of ROS 1 and ROS 2, read with `rosbags`, replayed through nodes on the virtual clock."""
