#!/usr/bin/env python3
"""Joystick node of a powered wheelchair: curve, limits, and slowing down in front of obstacles."""

from dataclasses import dataclass, field

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Joy, Range
from std_msgs.msg import Float32


@dataclass
class Stick:
    forward: float = 0.0
    left: float = 0.0
    stamp: float = -1.0


@dataclass
class Profile:
    """Settings that a therapist chooses for one user."""

    dead_zone: float = 0.06
    expo: float = 0.25
    max_forward: float = 0.9  # m/s
    max_backward: float = 0.35
    max_turn: float = 1.1  # rad/s
    turn_at_speed: float = 0.35  # share of the turn rate that is lost at full speed
    clearance: float = 0.45  # distance at which the chair stops (m)
    slow_zone: float = 1.3
    stick_timeout: float = 0.4  # s


@dataclass
class Surroundings:
    front: float = 4.0
    speed: float = 0.0
    charge: float = 1.0
    horn: bool = False
    notes: list = field(default_factory=list)


class TremorChair(Node):
    def __init__(self, profile):
        super().__init__("joystick_drive")
        self.profile = profile
        self.stick = Stick()
        self.around = Surroundings()
        self.drive = self.create_publisher(Twist, "cmd_vel", 5)
        self.create_subscription(Joy, "joy", self.on_joy, qos_profile_sensor_data)
        self.create_subscription(Range, "front_range", self.on_range, qos_profile_sensor_data)
        self.create_subscription(Odometry, "odom", self.on_odom, 5)
        self.create_subscription(Float32, "charge", self.on_charge, 1)
        self.create_timer(1.0 / 20.0, self.cycle)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def on_joy(self, msg):
        self.stick.left = msg.axes[0]
        self.stick.forward = msg.axes[1]
        self.stick.stamp = self.now()
        self.around.horn = bool(msg.buttons[0])

    def on_range(self, msg):
        self.around.front = min(max(msg.range, msg.min_range), msg.max_range)

    def on_odom(self, msg):
        self.around.speed = msg.twist.twist.linear.x

    def on_charge(self, msg):
        self.around.charge = msg.data
        if msg.data < 0.15 and "charge" not in self.around.notes:
            self.around.notes.append("charge")
            self.get_logger().warning("charge the battery")

    def shaped(self, deflection):
        """Apply the dead zone and the exponential curve to a deflection of the stick."""
        size = abs(deflection)
        if size < self.profile.dead_zone:
            return 0.0
        size = (size - self.profile.dead_zone) / (1.0 - self.profile.dead_zone)
        size = (1.0 - self.profile.expo) * size + self.profile.expo * size**3
        return size if deflection > 0.0 else -size

    def slowing(self):
        room = self.around.front - self.profile.clearance
        return min(1.0, max(0.0, room / (self.profile.slow_zone - self.profile.clearance)))

    def cycle(self):
        twist = Twist()
        if self.now() - self.stick.stamp > self.profile.stick_timeout:
            self.drive.publish(twist)
            return
        forward = self.shaped(self.stick.forward)
        if forward >= 0.0:
            twist.linear.x = forward * self.profile.max_forward * self.slowing()
        else:
            twist.linear.x = forward * self.profile.max_backward
        turn = self.profile.max_turn * self.shaped(self.stick.left)
        share = 1.0 - self.profile.turn_at_speed * abs(self.around.speed) / self.profile.max_forward
        twist.angular.z = turn * share
        self.drive.publish(twist)


def main():
    rclpy.init()
    rclpy.spin(TremorChair(Profile()))


if __name__ == "__main__":
    main()
