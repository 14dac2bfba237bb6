#!/usr/bin/env python3
"""Drive a tractor along a furrow, with an implement behind it."""

import rclpy
from geometry_msgs.msg import Twist
from guidance import FurrowGuide
from powertrain import hitch_height, throttle
from rclpy.node import Node
from std_msgs.msg import Float32, Float32MultiArray

PERIOD = 0.1  # s


class Tractor(Node):
    """Compute the commands from camera, wheels and hitch."""

    def __init__(self):
        super().__init__("tractor")
        self.declare_parameter("pace", 1.5)
        self.pace = self.get_parameter("pace").value
        self.guide = FurrowGuide()
        self.seen = False
        self.speed = 0.0
        self.depth = 0.0
        self.create_subscription(Float32MultiArray, "/furrow", self.on_furrow, 10)
        self.create_subscription(Float32, "/speed", self.on_speed, 10)
        self.create_subscription(Float32, "/depth", self.on_depth, 10)
        self.drive = self.create_publisher(Twist, "/drive", 10)
        self.hitch = self.create_publisher(Float32, "/hitch", 10)
        self.create_timer(PERIOD, self.on_timer)

    def on_furrow(self, msg):
        """Store the furrow as seen by the camera: lateral offset in m, angle in rad, contrast."""
        offset, angle, contrast = msg.data
        if contrast > 0.4:
            self.guide.see(offset, angle)
            self.seen = True

    def on_speed(self, msg):
        """Store the smoothed speed over ground."""
        self.speed += 0.5 * (msg.data - self.speed)

    def on_depth(self, msg):
        """Store the depth of the implement."""
        self.depth = 0.8 * self.depth + 0.2 * msg.data

    def on_timer(self):
        """Send the commands of this period."""
        if not self.seen:
            return
        cmd = Twist()
        cmd.angular.z = self.guide.steering(self.speed)
        cmd.linear.x = throttle(self.pace, self.speed, cmd.angular.z)
        self.drive.publish(cmd)
        self.hitch.publish(Float32(data=hitch_height(self.depth, self.speed)))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Tractor())


if __name__ == "__main__":
    main()
