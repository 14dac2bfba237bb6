"""Episodes per CPU second of the in-process ROS: 100 control steps of a small rospy and a small rclpy node.

Run `python benchmarks/ros.py`. Every node is driven twice and must take the same path to the last bit.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time
from typing import Any

from pytest_tarl.ros import Ros, message_type

STEPS = 100
ROSPY_NODE = """
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

position = 0.0

def callback(data):
    global position
    position = data.pose.pose.position.x

def travel(goal, pub, rate):
    delta = goal - position
    while abs(delta) > 0.1 and not rospy.is_shutdown():
        delta = goal - position
        pub.publish(5 * delta)
        rate.sleep()

rospy.init_node("traveller")
rospy.Subscriber("odom", Odometry, callback)
pub = rospy.Publisher("cmd_vel", Float64, queue_size=1)
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    travel(10, pub, rate)
    travel(0, pub, rate)
"""
RCLPY_NODE = """
import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

class Traveller(Node):
    def __init__(self):
        super().__init__("traveller")
        self.position, self.goal = 0.0, 10.0
        self.create_subscription(Odometry, "odom", self.callback, 10)
        self.pub = self.create_publisher(Float64, "cmd_vel", 10)
        self.create_timer(0.1, self.control)

    def callback(self, data):
        self.position = data.pose.pose.position.x

    def control(self):
        delta = self.goal - self.position
        if abs(delta) < 0.1:
            self.goal = 10.0 - self.goal
        self.pub.publish(Float64(data=5 * delta))

rclpy.init()
try:
    rclpy.spin(Traveller())
except ExternalShutdownException:
    pass
"""


def episode(program: Callable[[], None], odometry_type: type[Any]) -> list[float]:
    """Drive a node for `STEPS` steps; return where the robot was after each."""
    ros = Ros()
    odometry = odometry_type()
    position, path = 0.0, []
    with ros.installed():
        ros.start(program, name="traveller.py")
        for _ in range(STEPS):
            odometry.pose.pose.position.x = position
            ros.bus.publish("/odom", odometry)
            ros.step(0.1)
            command = ros.bus.latest("/cmd_vel")
            if command is not None:
                position += 0.1 * max(-10.0, min(10.0, command.data))
            path.append(position)
        ros.close()
    return path


def main() -> None:
    """Print one row for each client library."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3.0, help="CPU seconds to measure each row")
    seconds = parser.parse_args().seconds
    print(f"{'embedded':<10}{'episodes/s':>12}{'µs a step':>12}   reproducible")
    for name, source, odometry in (
        ("rospy", ROSPY_NODE, message_type("nav_msgs/Odometry")),
        ("rclpy", RCLPY_NODE, message_type("nav_msgs/msg/Odometry")),
    ):
        code = compile(source, f"<{name} traveller>", "exec")

        def program(code: Any = code) -> None:
            exec(code, {"__name__": "__main__"})  # noqa: S102 (the node above)

        first = episode(program, odometry)
        same, count, began = True, 0, process_time()
        while process_time() - began < seconds:
            same &= episode(program, odometry) == first
            count += 1
        rate = count / (process_time() - began)
        print(f"{name:<10}{rate:>12.0f}{1e6 / rate / STEPS:>12.1f}   {'to the last bit' if same else 'NO'}")


if __name__ == "__main__":
    main()
