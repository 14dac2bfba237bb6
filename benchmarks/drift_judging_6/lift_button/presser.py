#!/usr/bin/env python3
"""Press the button of a lift with the arm of a delivery robot."""

from enum import Enum

import rclpy
from geometry_msgs.msg import PointStamped
from kinematics import inverse
from rclpy.node import Node
from std_msgs.msg import Bool, Float64MultiArray


class Phase(Enum):
    SEARCH = 0
    HOVER = 1
    PRESS = 2
    RETRACT = 3


class ButtonPresser(Node):
    HOVER_GAP = 0.07  # distance in front of the panel (m)
    PRESS_DEPTH = 0.014  # distance beyond the panel (m); the finger has a spring
    HOVER_TIME = 1.5  # s
    PRESS_TIME = 1.2  # s

    def __init__(self):
        super().__init__("button_presser")
        self.phase = Phase.SEARCH
        self.since = 0.0
        self.sightings = []
        self.create_subscription(PointStamped, "/panel/button", self.button_callback, 10)
        self.joints = self.create_publisher(Float64MultiArray, "/arm/joints", 10)
        self.finished = self.create_publisher(Bool, "/press/finished", 10)
        self.create_timer(0.1, self.timer_callback)

    def now(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def button_callback(self, msg):
        if self.phase in (Phase.SEARCH, Phase.HOVER):
            self.sightings.append((msg.point.x, msg.point.z))

    def button(self):
        recent = self.sightings[-10:]
        return (
            sum(x for x, _ in recent) / len(recent),
            sum(z for _, z in recent) / len(recent),
        )

    def enter(self, phase):
        self.get_logger().info(f"{self.phase.name} -> {phase.name}")
        self.phase = phase
        self.since = self.now()

    def move(self, x, z):
        angles = inverse(x, z)
        if angles is None:
            self.get_logger().warn(f"({x:.2f}, {z:.2f}) is out of reach")
            return
        self.joints.publish(Float64MultiArray(data=angles))

    def timer_callback(self):
        waited = self.now() - self.since
        if self.phase is Phase.SEARCH:
            if len(self.sightings) >= 5:
                self.enter(Phase.HOVER)
            return
        x, z = self.button()
        if self.phase is Phase.HOVER:
            self.move(x - self.HOVER_GAP, z)
            if waited > self.HOVER_TIME:
                self.enter(Phase.PRESS)
        elif self.phase is Phase.PRESS:
            self.move(x + self.PRESS_DEPTH, z)
            if waited > self.PRESS_TIME:
                self.enter(Phase.RETRACT)
        else:
            self.move(x - self.HOVER_GAP, z)
            self.finished.publish(Bool(data=waited > 1.0))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(ButtonPresser())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
