#!/usr/bin/env python3
"""Tractor that welds a long joint: a laser looks ahead, and a cross slide keeps the torch on the joint."""

import rclpy
from geometry_msgs.msg import PointStamped
from joint_memory import JointMemory
from rclpy.node import Node
from std_msgs.msg import Bool, Float32

LEAD = 45.0  # distance from the torch to the line of the laser (mm)
TRAVEL = 6.0  # mm/s
CREEP = 12.0  # speed without the arc (mm/s)
SLIDE_GAIN = 3.0  # 1/s
SLIDE_MAX = 12.0  # mm/s
ZERO = 0.0  # offset between tracker and torch (mm)
ARC_WITHIN = 2.0  # mm
MIN_QUALITY = 0.4


class WeldTractor(Node):
    def __init__(self):
        super().__init__("weld_tractor")
        self.memory = JointMemory(LEAD)
        self.travelled = None
        self.slide = 0.0
        self.lost = 0
        self.arc = False
        self.pub_slide = self.create_publisher(Float32, "slide/velocity", 10)
        self.pub_travel = self.create_publisher(Float32, "tractor/speed", 10)
        self.pub_arc = self.create_publisher(Bool, "torch/arc", 10)
        self.create_subscription(PointStamped, "tracker/joint", self.on_joint, 10)
        self.create_subscription(Float32, "tractor/travelled", self.on_travelled, 10)
        self.create_subscription(Float32, "slide/position", self.on_slide, 10)
        self.create_timer(0.2, self.control)

    def on_travelled(self, msg):
        self.travelled = msg.data

    def on_slide(self, msg):
        self.slide = msg.data

    def on_joint(self, msg):
        """Keep what the laser sees: y is the offset from the tractor's middle, z the quality."""
        if self.travelled is None:
            return
        if msg.point.z < MIN_QUALITY:
            self.lost += 1
            return
        self.lost = 0
        self.memory.add(self.travelled, msg.point.y - ZERO)

    def slide_speed(self, error):
        return max(-SLIDE_MAX, min(SLIDE_MAX, SLIDE_GAIN * error))

    def control(self):
        if self.travelled is None:
            return
        wanted = self.memory.offset(self.travelled)
        if wanted is None:  # the torch has not yet reached the first point that the laser measured
            self.send(CREEP, 0.0, False)
            return
        error = wanted - self.slide
        if not self.arc:
            self.arc = abs(error) < ARC_WITHIN
        travel = TRAVEL if self.lost < 10 else 0.0
        self.send(travel if self.arc else 0.0, self.slide_speed(error), self.arc and travel > 0.0)

    def send(self, travel, slide, arc):
        self.pub_travel.publish(Float32(data=travel))
        self.pub_slide.publish(Float32(data=slide))
        self.pub_arc.publish(Bool(data=arc))


def main():
    rclpy.init()
    rclpy.spin(WeldTractor())


if __name__ == "__main__":
    main()
