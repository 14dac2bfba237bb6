"""Run the same tests on an installed ROS, in lock-step with the simulation.

Tests use the interface of `pytest_tarl.ros.Ros`. Nodes import the installed rospy or rclpy, which transports the
messages. ROS is imported only when an episode needs it.
"""
