#!/usr/bin/env python3
"""Porter on tracks: carry supplies up a marked path to a mountain hut."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import BatteryState, Range
from std_msgs.msg import Float32

PATH = [(0.0, 0.0), (160.0, 30.0), (290.0, 120.0), (430.0, 150.0), (520.0, 240.0)]  # m
CRUISE = 1.5  # m/s
STEEP = 1.4  # reduction of the speed per unit of slope
REACHED = 4.0  # distance from a point of the path (m)
TURN = 0.3  # turn rate per angle error (1/s)
SHARP = 0.7  # heading error (rad)
LOW = 0.03  # share of the charge
CLEARANCE = 0.35  # distance from the belly to the ground (m)


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


class MountainPorter(Node):
    def __init__(self):
        super().__init__("mountain_porter")
        self.pose = None
        self.slope = 0.0
        self.charge = 1.0
        self.goal = 1
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_subscription(Float32, "imu/slope", self.on_slope, 10)
        self.create_subscription(BatteryState, "battery", self.on_battery, 10)
        self.create_subscription(Range, "belly/range", self.on_belly, 10)
        self.create_timer(2.0, self.drive)

    def on_odom(self, msg):
        q = msg.pose.pose.orientation
        self.pose = (msg.pose.pose.position.x, msg.pose.pose.position.y, 2.0 * math.atan2(q.z, q.w))

    def on_slope(self, msg):
        self.slope += 0.5 * (msg.data - self.slope)

    def on_battery(self, msg):
        self.charge = msg.percentage

    def on_belly(self, msg):
        if msg.range < 0.2 * CLEARANCE:
            self.get_logger().warn("the belly drags", once=True)

    def heading_error(self, x, y, yaw):
        px, py = PATH[self.goal]
        if math.hypot(px - x, py - y) < REACHED and self.goal < len(PATH) - 1:
            self.goal += 1
            px, py = PATH[self.goal]
        return wrapped(math.atan2(py - y, px - x) - yaw)

    def speed(self, error):
        """Return the speed for the slope, less in sharp turns."""
        speed = CRUISE * (1.0 - STEEP * max(0.0, self.slope))
        if abs(error) > SHARP:
            speed = min(speed, 0.4)
        return max(0.2, speed)

    def drive(self):
        if self.pose is None:
            return
        twist = Twist()
        if self.charge > LOW:
            error = self.heading_error(*self.pose)
            twist.linear.x = self.speed(error)
            twist.angular.z = max(-0.8, min(0.8, TURN * error))
        else:
            self.get_logger().error("stopped: the battery is empty", once=True)
        self.cmd.publish(twist)


def main():
    rclpy.init()
    rclpy.spin(MountainPorter())


if __name__ == "__main__":
    main()
