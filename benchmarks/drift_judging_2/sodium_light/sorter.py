#!/usr/bin/env python3
"""Sort tomatoes on a belt: ripe ones go straight on, green ones are pushed off by a flap."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, ColorRGBA


class Sorter(Node):
    """Average the camera's colour while a fruit is in view, decide when it leaves."""

    HUE_LIMIT = 0.17  # share of a turn; fruits with a larger hue are green
    MIN_SATURATION = 0.15
    MIN_FRAMES = 2
    FLAP_SECONDS = 0.6
    DELAY_SECONDS = 0.4

    def __init__(self):
        super().__init__("sorter")
        self.hues = []
        self.flap_from = None
        self.in_view = False
        self.create_subscription(ColorRGBA, "camera/colour", self.colour_cb, 10)
        self.create_subscription(Bool, "camera/in_view", self.view_cb, 10)
        self.flap_pub = self.create_publisher(Bool, "flap", 10)
        self.create_timer(0.1, self.timer_cb)

    @staticmethod
    def to_hsv(red, green, blue):
        """Return hue (0 red, 1/3 green) and saturation."""
        top, low = max(red, green, blue), min(red, green, blue)
        spread = top - low
        if spread < 1e-6:
            return 0.0, 0.0
        if top == red:
            hue = (green - blue) / spread / 6.0
        elif top == green:
            hue = (2.0 + (blue - red) / spread) / 6.0
        else:
            hue = (4.0 + (red - green) / spread) / 6.0
        return hue, spread / top

    def colour_cb(self, msg):
        """Collect the hue of a fruit."""
        if not self.in_view:
            return
        hue, saturation = self.to_hsv(msg.r, msg.g, msg.b)
        if saturation > self.MIN_SATURATION:
            self.hues.append(hue)

    def view_cb(self, msg):
        """Decide when a fruit leaves the view."""
        if self.in_view and not msg.data:
            self.decide()
        self.in_view = msg.data

    def decide(self):
        """Schedule the flap for a green fruit."""
        if len(self.hues) >= self.MIN_FRAMES:
            mean = sum(self.hues) / len(self.hues)
            if mean > self.HUE_LIMIT:
                self.flap_from = self.seconds() + self.DELAY_SECONDS
        self.hues = []

    def seconds(self):
        """Return the time."""
        return self.get_clock().now().nanoseconds * 1e-9

    def timer_cb(self):
        """Command the flap."""
        out = False
        if self.flap_from is not None:
            late = self.seconds() - self.flap_from
            out = 0.0 <= late < self.FLAP_SECONDS
            if late >= self.FLAP_SECONDS:
                self.flap_from = None
        self.flap_pub.publish(Bool(data=out))


def main():
    """Start the sorter."""
    rclpy.init()
    rclpy.spin(Sorter())


if __name__ == "__main__":
    main()
