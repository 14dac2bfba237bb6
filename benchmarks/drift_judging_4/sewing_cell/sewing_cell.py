#!/usr/bin/env python3
"""Sew the seam that the pattern server requests.

Needle, feed dog and thread brake are one machine with three set points: stitches per second, millimetres of feed for
a stitch, tension of the upper thread.
"""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Float64MultiArray

CORNER_ZONE = 8.0  # distance before and behind a corner (mm)


class SewingCell(Node):
    def __init__(self):
        super().__init__("sewing_cell")
        for name in ("feed_ratio", "tension_base", "tension_per_mm", "corner_slow", "speed"):
            self.declare_parameter(name, 1.0)
        self.seam = None
        self.sewn = 0.0
        self.pub = {
            name: self.create_publisher(Float32, f"machine/{name}", 10)
            for name in ("feed", "tension", "speed")
        }
        self.done_pub = self.create_publisher(Bool, "cell/done", 10)
        self.create_subscription(Float64MultiArray, "pattern/seam", self.on_seam, 10)
        self.create_subscription(Float32, "machine/sewn", self.on_sewn, 10)
        self.create_timer(0.05, self.on_timer)

    def p(self, name):
        return self.get_parameter(name).get_parameter_value().double_value

    def on_seam(self, msg):
        """Store the seam [stitch, length, corner, corner, ...], in mm."""
        stitch, length, *corners = msg.data
        self.seam = {"stitch": stitch, "length": length, "corners": corners}

    def on_sewn(self, msg):
        self.sewn = msg.data

    def feed(self):
        """Return the feed for the stitch of this seam."""
        return self.seam["stitch"] * self.p("feed_ratio")

    def tension(self):
        """Return the thread tension, which is larger for longer stitches because they take more thread."""
        return self.p("tension_base") + self.p("tension_per_mm") * self.seam["stitch"]

    def speed(self):
        near = any(abs(self.sewn - corner) < CORNER_ZONE for corner in self.seam["corners"])
        return self.p("speed") * (self.p("corner_slow") if near else 1.0)

    def on_timer(self):
        if self.seam is None:
            return
        finished = self.sewn >= self.seam["length"]
        self.pub["feed"].publish(Float32(data=self.feed()))
        self.pub["tension"].publish(Float32(data=self.tension()))
        self.pub["speed"].publish(Float32(data=0.0 if finished else self.speed()))
        self.done_pub.publish(Bool(data=finished))


def main():
    rclpy.init()
    cell = SewingCell()
    rclpy.spin(cell)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
