#!/usr/bin/env python3
"""Prints a part in resin, layer by layer: dips the plate, waits for the resin to flow, exposes, and peels."""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String

PERIOD = 0.1


class Phase(Enum):
    LOWER = "lower"
    SETTLE = "settle"
    EXPOSE = "expose"
    LIFT = "lift"
    DONE = "done"


class ResinPrinter(Node):
    def __init__(self):
        super().__init__("resin_printer")
        self.declare_parameters(
            "",
            [
                ("layer_height", 0.05),  # mm
                ("bottom_layers", 3),
                ("bottom_exposure", 8.0),  # s, so that the part sticks to the plate
                ("exposure", 2.4),  # s, grey resin
                ("lift_height", 3.0),  # mm
                ("lift_speed", 2.0),  # mm/s
                ("lower_speed", 2.5),
                ("settle", 0.8),  # s
                ("peel_limit", 28.0),  # N
                ("vat_min", 12.0),  # degrees
                ("vat_max", 38.0),
            ],
        )
        self.phase = Phase.LOWER
        self.layer = 0
        self.layers = 0
        self.left = 0.0
        self.offset = self.param("lift_height")  # mm above the next layer
        self.vat = None
        self.peel = 0.0
        self.lamp = self.create_publisher(Bool, "lamp/on", 10)
        self.axis = self.create_publisher(Float32, "axis/speed", 10)
        self.number = self.create_publisher(Int32, "printer/layer", 10)
        self.status = self.create_publisher(String, "printer/phase", 10)
        self.create_subscription(Int32, "job/layers", self.on_job, 10)
        self.create_subscription(Float32, "vat/temperature", self.on_vat, 10)
        self.create_subscription(Float32, "plate/force", self.on_force, 10)
        self.create_timer(PERIOD, self.tick)

    def param(self, name):
        return self.get_parameter(name).value

    def on_job(self, msg):
        self.layers = msg.data

    def on_vat(self, msg):
        self.vat = msg.data
        if not self.param("vat_min") < self.vat < self.param("vat_max"):
            self.get_logger().warn(f"vat at {self.vat:.1f} degrees, prints may fail")

    def on_force(self, msg):
        self.peel = max(0.9 * self.peel, msg.data)

    def exposure_time(self):
        if self.layer < self.param("bottom_layers"):
            return self.param("bottom_exposure")
        return self.param("exposure")

    def tick(self):
        if self.vat is None or not self.layers:
            return
        speed, light = 0.0, False
        if self.phase == Phase.LOWER:
            speed = -self.param("lower_speed")
            self.offset += PERIOD * speed
            if self.offset <= 0.0:
                self.offset, speed = 0.0, 0.0
                self.left = self.param("settle")
                self.phase = Phase.SETTLE
        elif self.phase == Phase.SETTLE:
            self.left -= PERIOD
            if self.left < 1e-6:
                self.left = self.exposure_time()
                self.phase = Phase.EXPOSE
        elif self.phase == Phase.EXPOSE:
            light = self.left > 0.5 * PERIOD
            self.left -= PERIOD
            if not light:
                self.phase = Phase.LIFT
        elif self.phase == Phase.LIFT:
            # slow down when the film holds on
            speed = self.param("lift_speed") * (0.5 if self.peel > self.param("peel_limit") else 1.0)
            self.offset += PERIOD * speed
            if self.offset >= self.param("lift_height"):
                self.layer += 1
                self.phase = Phase.LOWER if self.layer < self.layers else Phase.DONE
                if self.phase == Phase.DONE:
                    self.get_logger().info(f"{self.layer} layers printed")
        self.lamp.publish(Bool(data=light))
        self.axis.publish(Float32(data=speed))
        self.number.publish(Int32(data=self.layer))
        self.status.publish(String(data=self.phase.value))


def main(args=None):
    rclpy.init(args=args)
    printer = ResinPrinter()
    rclpy.spin(printer)
    printer.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
