#!/usr/bin/env python3
"""Brew a pot of tea: boil, lower the basket, wait, lift the basket, pour."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure, Temperature
from std_msgs.msg import Float32, String

STEEP = {"green": 90.0, "black": 150.0, "herbal": 240.0}  # s
HEAT = {"green": 80.0, "black": 97.0, "herbal": 97.0}  # degC
BASKET_SPEED = 0.02  # m/s
DIP = 0.12  # m


class TeaBrewer(Node):
    def __init__(self):
        super().__init__("tea_brewer")
        self.kind = None
        self.water = 20.0
        self.slope = 0.0
        self.pressure = 1013.0
        self.state = "idle"
        self.since = None
        self.create_subscription(String, "order", self.on_order, 1)
        self.create_subscription(Temperature, "kettle/temperature", self.on_temperature, 10)
        self.create_subscription(FluidPressure, "air/pressure", self.on_pressure, 10)
        self.heater = self.create_publisher(Float32, "kettle/power", 1)
        self.basket = self.create_publisher(Float32, "basket/depth", 1)
        self.display = self.create_publisher(String, "display", 1)
        self.create_timer(2.0, self.on_timer)

    def on_order(self, msg):
        if self.state == "idle":
            self.kind = msg.data
            self.state = "heat"

    def on_temperature(self, msg):
        self.slope = msg.temperature - self.water
        self.water = msg.temperature

    def on_pressure(self, msg):
        self.pressure = msg.fluid_pressure / 100.0

    def on_timer(self):
        now = self.get_clock().now().nanoseconds * 1e-9
        power, depth = 0.0, 0.0
        if self.state == "heat":
            power = 1.0
            boils = self.water > 70.0 and abs(self.slope) < 0.5
            if self.water > HEAT[self.kind] or boils:
                self.state = "steep"
                self.since = now
        elif self.state == "steep":
            depth = DIP
            power = 0.15 if self.water < HEAT[self.kind] else 0.0
            if now - self.since > STEEP[self.kind]:
                self.state = "pour"
        self.heater.publish(Float32(data=power))
        self.basket.publish(Float32(data=depth))
        self.display.publish(String(data="%s %.0f C %.0f hPa" % (self.state, self.water, self.pressure)))


def main():
    rclpy.init()
    rclpy.spin(TeaBrewer())


if __name__ == "__main__":
    main()
