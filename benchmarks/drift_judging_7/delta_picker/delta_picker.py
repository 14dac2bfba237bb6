#!/usr/bin/env python3
import rclpy
from belt import BeltTracker
from rclpy.node import Node
from std_msgs.msg import Float64, Int32

HEAD_DOWN = 0.05  # time in which the head comes down (s)


class DeltaPicker(Node):
    """Pick biscuits from the running belt: close the gripper when a biscuit is below it."""

    def __init__(self):
        super().__init__("delta_picker")
        self.declare_parameter("camera_to_robot", 400.0)
        self.belt = BeltTracker(self.get_parameter("camera_to_robot").value)
        self.ticks = None
        self.rate = 0.0
        self.grip_pub = self.create_publisher(Float64, "delta/grip_in", 5)
        self.create_subscription(Int32, "belt/ticks", self.ticks_cb, 20)
        self.create_subscription(Float64, "camera/part", self.part_cb, 20)

    def part_cb(self, msg):
        if self.ticks is not None:
            self.belt.add(self.ticks, msg.data)

    def ticks_cb(self, msg):
        if self.ticks is not None:
            self.rate = (msg.data - self.ticks) / 0.1
        self.ticks = msg.data
        self.plan()

    def plan(self):
        if not self.belt.parts or self.rate <= 0:
            return
        part = self.belt.parts[0]
        ahead = self.belt.ahead(part, self.ticks)
        speed = self.belt.travelled(0, self.rate)
        wait = ahead / speed - HEAD_DOWN
        if wait < 0.1:
            self.belt.parts.pop(0)
            self.grip_pub.publish(Float64(data=max(0.0, wait)))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(DeltaPicker())


if __name__ == "__main__":
    main()
