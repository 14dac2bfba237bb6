#!/usr/bin/env python3
"""Attach the cups of a milking robot one after the other.

The camera reports the next teat. The arm goes below it, waits until teat and arm are quiet, moves up and
switches on the vacuum of the cup.
"""

import rclpy
from camera_frame import distance, to_arm
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, UInt8

SEARCH, BELOW, RAISE, VACUUM, DONE = range(5)
TEATS = 4


class MilkingArm(Node):
    def __init__(self):
        super().__init__("milking_arm")
        self.declare_parameter("clearance", 0.09)  # gap to the teat before the cup is raised (m)
        self.declare_parameter("smoothing", 0.5)
        self.declare_parameter("raise_speed", 0.12)  # m/s
        self.declare_parameter("settled", 0.012)  # m
        self.clearance = self.get_parameter("clearance").value
        self.smoothing = self.get_parameter("smoothing").value
        self.raise_speed = self.get_parameter("raise_speed").value
        self.settled = self.get_parameter("settled").value

        self.state = SEARCH
        self.teat = None
        self.seen = 0
        self.tool = (0.2, 0.0, 0.1)
        self.lift = 0.0
        self.attached = 0
        self.milk_flow = 0.0
        self.target_pub = self.create_publisher(PointStamped, "arm/target", 10)
        self.vacuum_pub = self.create_publisher(Bool, "cup/vacuum", 10)
        self.create_subscription(PointStamped, "camera/teat", self.on_teat, 10)
        self.create_subscription(PointStamped, "arm/tool", self.on_tool, 10)
        self.create_subscription(UInt8, "cup/attached", self.on_attached, 10)
        self.create_subscription(Float32, "milk/flow", self.on_flow, 10)
        self.dt = 0.1
        self.create_timer(self.dt, self.step)

    def on_teat(self, msg):
        point = to_arm(msg.point)
        if self.teat is None or distance(point, self.teat) > 0.1:
            self.teat, self.seen = point, 1
            return
        a = self.smoothing
        self.teat = tuple(old + a * (new - old) for old, new in zip(self.teat, point))
        self.seen += 1

    def on_tool(self, msg):
        self.tool = (msg.point.x, msg.point.y, msg.point.z)

    def on_attached(self, msg):
        if msg.data != self.attached:
            self.attached = msg.data
            self.get_logger().info(f"cup {self.attached} of {TEATS} holds")
            self.restart()

    def on_flow(self, msg):
        self.milk_flow = msg.data

    def restart(self):
        self.teat, self.seen = None, 0
        self.lift = 0.0
        self.state = DONE if self.attached == TEATS else SEARCH
        self.vacuum_pub.publish(Bool(data=False))

    def go(self, below):
        x, y, z = self.teat
        msg = PointStamped()
        msg.header.frame_id = "arm_base"
        msg.header.stamp = self.get_clock().now().to_msg()
        msg.point.x, msg.point.y, msg.point.z = x, y, z - below
        self.target_pub.publish(msg)
        return distance(self.tool, (x, y, z - below))

    def step(self):
        if self.teat is None or self.state == DONE:
            return
        if self.state == SEARCH:
            if self.seen >= 3:
                self.state = BELOW
        elif self.state == BELOW:
            if self.go(self.clearance) < self.settled:
                self.state = RAISE
        elif self.state == RAISE:
            self.lift = min(self.clearance, self.lift + self.raise_speed * self.dt)
            off = self.go(self.clearance - self.lift)
            if self.lift >= self.clearance and off < self.settled:
                self.state = VACUUM
                self.vacuum_pub.publish(Bool(data=True))
        elif self.state == VACUUM:
            self.go(0.0)


def main(args=None):
    rclpy.init(args=args)
    node = MilkingArm()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == "__main__":
    main()
