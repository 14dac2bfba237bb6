"""Measure episodes per second (of 100 control steps) of small rospy and rclpy nodes, in-process and on a real ROS.

Run `python benchmarks/ros.py`; for a real ROS, use the Python of `.venv-ros1` or `.venv-ros2` (`make setup-ros1
setup-ros2`). The robot must take the same path in every episode, to the last bit, even on a real ROS.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib.machinery import PathFinder
from time import perf_counter, process_time
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


def episode(program: Callable[[], None], odometry_type: type[Any], ros: Ros) -> list[float]:
    """Drive a node for `STEPS` steps; return the robot's position after each."""
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


def real(library: str) -> Callable[[], Ros] | None:
    """Return a factory of episodes on a real ROS, or None if it is not installed."""
    if PathFinder.find_spec(library) is None:
        return None
    if library == "rospy":
        from pytest_tarl.realros.rospy_ros import RospyRos

        return RospyRos
    from pytest_tarl.realros.rclpy_ros import RclpyRos

    return RclpyRos


def measured(
    program: Callable[[], None],
    odometry: type[Any],
    make: Callable[[], Ros],
    path: list[float],
    seconds: float,
) -> tuple[float, float, bool]:
    """Return episodes per CPU second and per wall second, and whether all episodes took the given path."""
    same, count, cpu, wall = True, 0, process_time(), perf_counter()
    while process_time() - cpu < seconds:
        same &= episode(program, odometry, make()) == path
        count += 1
    return count / (process_time() - cpu), count / (perf_counter() - wall), same


def main() -> None:
    """Print a row for each client library and each installed kind of ROS."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3.0, help="CPU seconds to spend on each row")
    seconds = parser.parse_args().seconds
    print(f"{'':<16}{'episodes/CPU s':>16}{'episodes/s':>12}{'CPU µs a step':>15}   path")
    for name, source, odometry in (
        ("rospy", ROSPY_NODE, message_type("nav_msgs/Odometry")),
        ("rclpy", RCLPY_NODE, message_type("nav_msgs/msg/Odometry")),
    ):
        code = compile(source, f"<{name} traveller>", "exec")

        def program(code: Any = code) -> None:
            exec(code, {"__name__": "__main__"})  # noqa: S102 (the node above)

        path = episode(program, odometry, Ros())
        for kind, make in (("embedded", Ros), ("real", real(name))):
            if make is None:
                print(f"real {name:<11}{'not installed here':>16}")
                continue
            episode(program, odometry, make())  # warm up: connections are made
            cpu, wall, same = measured(program, odometry, make, path, seconds)
            told = "that of the embedded ROS, to the last bit" if same else "ANOTHER"
            print(f"{kind + ' ' + name:<16}{cpu:>16.1f}{wall:>12.1f}{1e6 / cpu / STEPS:>15.1f}   {told}")


if __name__ == "__main__":
    main()
