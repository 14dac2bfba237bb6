"""An episode knows the numbers that its nodes got as parameters from outside."""

from __future__ import annotations

from tests.plugin.ros.conftest import Start


def test_numbers_read_by_rospy_nodes_are_known(start: Start) -> None:
    ros = start(
        """
        import rospy

        rospy.init_node("keeper")
        rospy.get_param("~gain")
        rospy.get_param("~missing", 3.0)
        rospy.get_param("/limits")
        rospy.get_param("~name")
        """,
        parameters={
            "~gain": 2.0,
            "~unread": 1.0,
            "~name": "left",
            "/limits": {"low": 1, "up": {"on": True}, "t": "x"},
        },
    )
    ros.step(0.1)
    assert ros.parameters_read == {"/keeper/gain": 2.0, "/limits/low": 1, "/limits/up/on": True}


def test_numbers_given_to_rclpy_nodes_are_known(start: Start) -> None:
    ros = start(
        """
        import rclpy
        from rclpy.node import Node

        rclpy.init()
        node = Node("keeper", namespace="left")
        node.declare_parameter("pid.gain", 1.0)
        node.declare_parameter("rate", 4.0)
        """,
        parameters={"pid.gain": 2.0, "frame": "map"},
    )
    ros.step(0.1)
    assert ros.parameters_read == {"/left/keeper/pid/gain": 2.0}
