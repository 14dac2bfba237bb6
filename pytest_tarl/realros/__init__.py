"""Run the same tests on a real ROS: real names, messages, topics and clocks, in lock-step with the simulation.

Tests see the `Ros` of `pytest_tarl.ros`; what differs is what carries the messages and whose rospy or rclpy a node
imports. Nothing of ROS is imported until an episode asks for it.
"""
