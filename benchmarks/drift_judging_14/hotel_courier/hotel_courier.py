#!/usr/bin/env python3
"""Drive a courier robot along a hotel corridor from the server in the basement.

The robot localises itself and sends its pose over the wireless network; the commands go back the same way.
"""

import math

import rclpy
from geometry_msgs.msg import Pose2D, Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Float32, String


class SpeedProfile:
    """Trapezoid over the distance: accelerate, cruise, and slow down before the door."""

    def __init__(self, cruise, accel, period):
        self.cruise = cruise
        self.accel = accel
        self.period = period
        self.speed = 0.0

    def update(self, left):
        braking = math.sqrt(2.0 * self.accel * max(0.0, left))
        wanted = min(self.cruise, 0.7 * braking)
        step = self.accel * self.period
        self.speed += max(-step, min(step, wanted - self.speed))
        return self.speed


class HotelCourier(Node):
    def __init__(self):
        super().__init__("hotel_courier")
        self.declare_parameter("cruise_speed", 0.9)  # m/s
        self.declare_parameter("acceleration", 0.5)  # m/s2
        self.declare_parameter("lookahead", 0.65)  # m
        self.declare_parameter("max_yaw_rate", 1.2)  # rad/s
        self.declare_parameter("door_tolerance", 0.25)  # m
        self.lookahead = self.get_parameter("lookahead").value
        self.max_yaw_rate = self.get_parameter("max_yaw_rate").value
        self.door_tolerance = self.get_parameter("door_tolerance").value

        self.period = 0.1
        self.profile = SpeedProfile(
            self.get_parameter("cruise_speed").value, self.get_parameter("acceleration").value, self.period
        )
        self.pose = None
        self.door = None
        self.round_trip = 0.0
        self.worst_round_trip = 0.0
        self.state = "WAIT"

        qos = QoSProfile(depth=5)
        self.cmd_pub = self.create_publisher(Twist, "courier/cmd_vel", qos)
        self.state_pub = self.create_publisher(String, "courier/state", qos)
        self.create_subscription(Pose2D, "courier/pose", self.on_pose, qos)
        self.create_subscription(Float32, "courier/door", self.on_door, qos)
        self.create_subscription(Float32, "network/round_trip", self.on_round_trip, qos)
        self.create_timer(self.period, self.control)
        self.create_timer(10.0, self.report)

    def on_pose(self, msg):
        """x along the corridor, y to the left of its middle line."""
        self.pose = (msg.x, msg.y, msg.theta)

    def on_door(self, msg):
        if self.door != msg.data:
            self.door = msg.data
            self.state = "DRIVE"

    def on_round_trip(self, msg):
        self.round_trip = msg.data
        self.worst_round_trip = max(self.worst_round_trip, msg.data)

    def report(self):
        self.get_logger().info(f"{self.state}, round trip {self.worst_round_trip * 1000:.0f} ms at worst")
        self.worst_round_trip = 0.0

    def yaw_rate(self, speed):
        """Pure pursuit of the middle line."""
        _, y, theta = self.pose
        alpha = math.atan2(-y, self.lookahead) - theta
        curvature = 2.0 * math.sin(alpha) / self.lookahead
        return max(-self.max_yaw_rate, min(self.max_yaw_rate, speed * curvature))

    def control(self):
        if self.pose is None or self.door is None:
            return
        cmd = Twist()
        left = self.door - self.pose[0]
        if self.state == "DRIVE":
            if left < self.door_tolerance:
                self.state = "AT_DOOR"
            else:
                cmd.linear.x = max(0.1, self.profile.update(left))
                cmd.angular.z = self.yaw_rate(cmd.linear.x)
        self.cmd_pub.publish(cmd)
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    node = HotelCourier()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
