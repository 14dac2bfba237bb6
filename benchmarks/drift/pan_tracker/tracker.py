#!/usr/bin/env python3
"""Keep a moving target in the middle of a camera's image by panning."""

import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from std_msgs.msg import Float64


class PanTracker(Node):
    """Turn towards the detected target."""

    KP = 6.0  # 1/s
    KI = 0.8  # 1/s²
    MOST_WOUND = 0.3  # rad s
    RADIANS_PER_PIXEL = 0.0016
    MIDDLE = 320.0  # px
    DEADBAND = 4.0  # px
    MOST_RATE = 2.5  # rad/s
    SURE = 0.3  # detections with less confidence are ignored

    def __init__(self):
        super().__init__("pan_tracker")
        self.offset = 0.0
        self.wound = 0.0
        self.create_subscription(PointStamped, "/target", self.on_target, 10)
        self.rate = self.create_publisher(Float64, "/pan_rate", 10)
        self.create_timer(0.05, self.on_timer)

    def on_target(self, msg):
        """Store the position of the target in the image; z is the confidence of the detector."""
        if msg.point.z < self.SURE:
            return
        pixels = msg.point.x - self.MIDDLE
        if abs(pixels) < self.DEADBAND:
            pixels = 0.0
        self.offset = self.RADIANS_PER_PIXEL * pixels

    def on_timer(self):
        """Send one pan rate."""
        self.wound += self.offset * 0.05
        self.wound = max(-self.MOST_WOUND, min(self.MOST_WOUND, self.wound))
        rate = self.KP * self.offset + self.KI * self.wound
        if rate > self.MOST_RATE:
            rate = self.MOST_RATE
        elif rate < -self.MOST_RATE:
            rate = -self.MOST_RATE
        self.rate.publish(Float64(data=rate))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(PanTracker())


if __name__ == "__main__":
    main()
