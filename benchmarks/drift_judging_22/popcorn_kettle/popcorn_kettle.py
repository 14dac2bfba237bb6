#!/usr/bin/env python3
"""Popcorn kettle of a kiosk robot: listens to the pops, and tips the kettle when they have become rare."""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String, UInt8


class Step(Enum):
    WAIT = "wait"
    HEAT = "heat"
    POP = "pop"
    TIP = "tip"


class PopcornKettle(Node):
    def __init__(self):
        super().__init__("popcorn_kettle")
        self.step = Step.WAIT
        self.pops = 0
        self.last_pop = None
        self.heater = self.create_publisher(Float32, "kettle/heater", 1)
        self.tilt = self.create_publisher(Float32, "kettle/tilt", 1)
        self.display = self.create_publisher(String, "kiosk/display", 1)
        self.create_subscription(UInt8, "mic/pops", self.on_pops, 10)
        self.create_subscription(Bool, "kettle/filled", self.on_filled, 1)
        self.timer = self.create_timer(0.25, self.loop)

    def on_filled(self, msg):
        if msg.data and self.step is Step.WAIT:
            self.pops = 0
            self.step = Step.HEAT

    def on_pops(self, msg):
        if msg.data > 0:
            self.pops += msg.data
            self.last_pop = self.get_clock().now()

    def silence(self):
        """Seconds since the last pop."""
        return (self.get_clock().now() - self.last_pop).nanoseconds * 1e-9

    def power(self):
        if self.step is Step.HEAT:
            return 1.0
        return 0.75 if self.step is Step.POP else 0.0

    def loop(self):
        if self.step is Step.HEAT and self.pops > 7:
            self.step = Step.POP
        elif self.step is Step.POP and self.silence() > 1.4:
            self.get_logger().info(f"{self.pops} kernels popped")
            self.step = Step.TIP
        self.heater.publish(Float32(data=self.power()))
        self.tilt.publish(Float32(data=1.2 if self.step is Step.TIP else 0.0))
        self.display.publish(String(data=self.step.value))


def main(args=None):
    rclpy.init(args=args)
    kettle = PopcornKettle()
    try:
        rclpy.spin(kettle)
    except KeyboardInterrupt:
        pass
    kettle.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
