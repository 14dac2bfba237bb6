#!/usr/bin/env python3
"""Bends shopping baskets from wire: feeds, bends with a pin around a mandrel, and retracts, for each bend of a job."""

from collections import deque

import rclpy
from alloys import overbend
from rclpy.node import Node
from std_msgs.msg import Float32, Float32MultiArray, String


class WireBender(Node):
    FEED, BEND, RETRACT = "feed", "bend", "retract"

    def __init__(self):
        super().__init__("wire_bender")
        self.alloy = self.declare_parameter("alloy", "galvanised").value
        self.tolerance = self.declare_parameter("pin_tolerance", 0.2).value
        self.bends = deque()
        self.phase = None
        self.ticks = 0
        self.pin = 0.0
        self.hardness = 0.0
        self.pin_pub = self.create_publisher(Float32, "pin/target", 1)
        self.phase_pub = self.create_publisher(String, "bender/phase", 1)
        self.create_subscription(Float32MultiArray, "bender/job", self.job, 1)
        self.create_subscription(Float32, "pin/angle", self.pin_moved, 5)
        self.create_subscription(Float32, "coil/hardness", self.coil, 1)
        self.create_timer(0.1, self.tick)

    def job(self, msg):
        self.bends.extend(msg.data)
        self.get_logger().info(f"{len(msg.data)} bends, wire of {self.hardness:.0f} HV")
        self.enter(self.FEED)

    def coil(self, msg):
        self.hardness = msg.data

    def pin_moved(self, msg):
        self.pin = msg.data

    def enter(self, phase):
        self.phase = phase
        self.ticks = 0

    def reached(self, target):
        return abs(self.pin - target) < self.tolerance

    def tick(self):
        if self.phase is None:
            return
        self.ticks += 1
        target = 0.0
        if self.phase == self.FEED:
            if self.ticks > 4:
                self.enter(self.BEND)
        elif self.phase == self.BEND:
            target = overbend(self.bends[0], self.alloy)
            if self.reached(target):
                self.bends.popleft()
                self.enter(self.RETRACT)
        elif self.reached(0.0):
            self.enter(self.FEED if self.bends else None)
        self.pin_pub.publish(Float32(data=target))
        self.phase_pub.publish(String(data=self.phase or "done"))


def main():
    rclpy.init()
    rclpy.spin(WireBender())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
