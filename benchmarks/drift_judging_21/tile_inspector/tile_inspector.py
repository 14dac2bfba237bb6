#!/usr/bin/env python3
"""Grades glazed tiles by what the line camera measures, and stops the line for a fault of the kiln."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32MultiArray, Int8, String

FIRST, SECOND, REJECT = 0, 1, 2
MAX_IN_A_ROW = 4  # rejects, then something is wrong with the kiln
CHIP_AREA = 1.5  # mm^2


def crack_limit(glaze):
    """Contrast from which a dark line is a crack; glossy glazes mirror the lamps, and have more of it."""
    if glaze == "matt":
        return 0.2
    elif glaze == "satin":
        return 0.24
    elif glaze == "gloss":
        return 0.3
    return 0.27


class TileInspector(Node):
    def __init__(self):
        super().__init__("tile_inspector")
        self.glaze = "unknown"
        self.row = 0
        self.counts = [0, 0, 0]
        self.gate_pub = self.create_publisher(Int8, "gate", 10)
        self.stop_pub = self.create_publisher(Bool, "line/stop", 10)
        self.report_pub = self.create_publisher(String, "inspector/report", 10)
        self.create_subscription(String, "line/glaze", self.glaze_cb, 10)
        self.create_subscription(Float32MultiArray, "camera/tile", self.tile_cb, 10)
        self.create_timer(2.0, self.report)

    def glaze_cb(self, msg):
        if msg.data != self.glaze:
            self.get_logger().info(f"glaze: {msg.data}")
            self.glaze = msg.data
            self.row = 0

    def grade(self, contrast, chip):
        if contrast > crack_limit(self.glaze):
            return REJECT
        if chip > CHIP_AREA:
            return SECOND
        return FIRST

    def tile_cb(self, msg):
        contrast, chip = msg.data
        grade = self.grade(contrast, chip)
        self.counts[grade] += 1
        self.row = self.row + 1 if grade == REJECT else 0
        if self.row >= MAX_IN_A_ROW:
            self.get_logger().error("rejects in a row: check the kiln")
        self.gate_pub.publish(Int8(data=grade))
        self.stop_pub.publish(Bool(data=self.row >= MAX_IN_A_ROW))

    def report(self):
        self.report_pub.publish(String(data="%d first, %d second, %d rejected" % tuple(self.counts)))


def main():
    rclpy.init()
    rclpy.spin(TileInspector())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
