#!/usr/bin/env python3
"""Twist apples off their stems, one after the other."""

from enum import Enum, auto

import rclpy
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Step(Enum):
    REACH = auto()
    TWIST = auto()
    PULL = auto()
    NEXT = auto()


class ApplePicker(Node):
    def __init__(self):
        super().__init__("apple_picker")
        self.declare_parameters(
            "",
            [
                ("twist_rate", 2.4),  # rad/s
                ("twist_angle", 2.8),  # angle to either side (rad)
                ("max_twists", 3),  # maximum number of half turns before the apple is left for the next pass
                ("pull", 14.0),  # N
            ],
        )
        self.max_twists = self.get_parameter("max_twists").value
        self.state = Step.REACH
        self.angle = 0.0
        self.way = 1
        self.twists = 0
        self.attached = True
        self.load = 0.0
        self.wrist = self.create_publisher(Vector3, "wrist/command", 10)
        self.gripper = self.create_publisher(String, "gripper/command", 10)
        self.create_subscription(Float32, "wrist/torque", self.on_torque, 10)
        self.create_subscription(String, "arm/event", self.on_event, 10)
        self.create_timer(0.1, self.tick)

    def on_torque(self, msg):
        self.load = 0.5 * self.load + 0.5 * msg.data

    def on_event(self, msg):
        if msg.data == "at_apple":
            self.state, self.angle, self.way, self.twists = Step.TWIST, 0.0, 1, 0
        elif msg.data == "loose":
            self.state = Step.NEXT

    def send(self, rate=0.0, pull=0.0):
        self.wrist.publish(Vector3(x=float(rate), y=float(pull)))

    def tick(self):
        getattr(self, "do_" + self.state.name.lower())()

    def do_reach(self):
        self.send()

    def do_twist(self):
        rate = self.way * self.get_parameter("twist_rate").value
        self.angle += rate * 0.1
        if abs(self.angle) > self.get_parameter("twist_angle").value and self.angle * self.way > 0:
            self.way = -self.way
            self.twists += 1
        if self.twists >= self.max_twists:
            self.state = Step.PULL
        self.send(rate, 2.0)

    def do_pull(self):
        self.send(0.0, self.get_parameter("pull").value)
        self.gripper.publish(String(data="release"))
        self.state = Step.NEXT

    def do_next(self):
        self.send()
        self.gripper.publish(String(data="store"))
        self.state = Step.REACH


def main():
    rclpy.init()
    node = ApplePicker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == "__main__":
    main()
