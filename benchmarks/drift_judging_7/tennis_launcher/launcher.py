#!/usr/bin/env python3
"""Ball machine: lob balls over the net to the spots sent by the trainer's tablet."""

import math

import rclpy
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Float64

WHEEL_GRIP = 0.93
G = 9.81


class Launcher(Node):
    def __init__(self):
        super().__init__("launcher")
        self.elevation = self.declare_parameter("elevation_deg", 32.0).value
        self.steeper = self.declare_parameter("steeper_per_m", 0.8).value  # increase for near spots
        self.drag_gain = self.declare_parameter("drag_gain", 1.11).value
        self.wheel_radius = self.declare_parameter("wheel_radius", 0.11).value
        self.shots = 0
        self.pub = self.create_publisher(Vector3, "launcher/shot", 10)
        self.create_subscription(Float64, "tablet/spot", self.spot_callback, qos_profile_sensor_data)

    def angle(self, distance):
        return self.elevation + self.steeper * (14.0 - distance)

    def ball_speed(self, distance):
        """Return the launch speed without drag, multiplied by a factor for the drag."""
        radians = math.radians(self.angle(distance))
        plain = math.sqrt(G * distance / math.sin(2.0 * radians))
        return plain * self.drag_gain

    def wheel_speed(self, distance):
        return self.ball_speed(distance) / (WHEEL_GRIP * self.wheel_radius)

    def spot_callback(self, msg):
        self.shots += 1
        shot = Vector3()
        shot.x = self.wheel_speed(msg.data)
        shot.y = self.angle(msg.data)
        shot.z = float(self.shots)
        self.pub.publish(shot)


def main(args=None):
    rclpy.init(args=args)
    node = Launcher()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
