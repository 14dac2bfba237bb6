#!/usr/bin/env python3
"""Runs one fan gun of a ski resort: as much water as the air can freeze, while the compressor holds its pressure.

The weather mast gives the temperature and the humidity; how much water freezes depends on the wet bulb.
"""

import math

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String

START_BELOW = -2.5  # wet bulb, in degrees C
STOP_ABOVE = -1.8
FLOW_PER_DEGREE = 10.0  # l/min for each degree of the wet bulb below ZERO_FLOW
ZERO_FLOW = -0.5
FLOW_RANGE = (12.0, 95.0)  # l/min; below, the nozzles freeze
RAMP = 6.0  # l/min per period
PRESSURE_MIN = 3.5  # bar
STALE = 20.0  # s
PERIOD = 2.0


def wet_bulb(temperature, humidity):
    """Return the wet bulb in degrees C (Stull 2011), of a temperature in degrees C and a humidity in percent."""
    return (
        temperature * math.atan(0.151977 * math.sqrt(humidity + 8.313659))
        + math.atan(temperature + humidity)
        - math.atan(humidity - 1.676331)
        + 0.00391838 * humidity**1.5 * math.atan(0.023101 * humidity)
        - 4.686035
    )


class SnowGun(Node):
    def __init__(self):
        super().__init__("snow_gun")
        self.temperature = None
        self.humidity = None
        self.mast_seen = None
        self.pressure = 0.0
        self.low_pressure = 0
        self.enabled = False
        self.running = False
        self.flow = 0.0
        self.litres = 0.0
        self.swing = 0

        self.valve_pub = self.create_publisher(Float32, "gun/water", 1)
        self.fan_pub = self.create_publisher(Bool, "gun/fan", 1)
        self.yaw_pub = self.create_publisher(Float32, "gun/yaw", 1)
        self.status_pub = self.create_publisher(String, "gun/status", 1)
        self.create_subscription(Float32, "mast/temperature", self.on_temperature, 5)
        self.create_subscription(Float32, "mast/humidity", self.on_humidity, 5)
        self.create_subscription(Float32, "compressor/pressure", self.on_pressure, 5)
        self.create_subscription(Bool, "resort/enable", self.on_enable, 1)
        self.create_timer(PERIOD, self.control)
        self.create_timer(30.0, self.report)

    def seconds(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_temperature(self, msg):
        self.temperature = msg.data
        self.mast_seen = self.seconds()

    def on_humidity(self, msg):
        self.humidity = min(100.0, max(5.0, msg.data))

    def on_pressure(self, msg):
        self.pressure = msg.data
        self.low_pressure = self.low_pressure + 1 if msg.data < PRESSURE_MIN else 0

    def on_enable(self, msg):
        if msg.data != self.enabled:
            self.get_logger().info("enabled" if msg.data else "disabled")
        self.enabled = msg.data

    def allowed(self, bulb):
        """Decide with a hysteresis whether it is cold enough, and whether the gun has its air."""
        if not self.enabled or self.low_pressure > 2:
            return False
        return bulb < (STOP_ABOVE if self.running else START_BELOW)

    def wanted_flow(self, bulb):
        flow = FLOW_PER_DEGREE * (ZERO_FLOW - bulb)
        return min(FLOW_RANGE[1], max(FLOW_RANGE[0], flow))

    def control(self):
        if self.temperature is None or self.humidity is None:
            return
        if self.seconds() - self.mast_seen > STALE:
            self.get_logger().warning("mast is silent", throttle_duration_sec=30.0)
            self.running = False
        else:
            bulb = wet_bulb(self.temperature, self.humidity)
            self.running = self.allowed(bulb)
        if self.running:
            target = self.wanted_flow(bulb)
            self.flow += min(RAMP, max(-RAMP, target - self.flow))
        else:
            self.flow = 0.0
        self.litres += self.flow * PERIOD / 60.0
        self.swing = (self.swing + 1) % 60
        self.valve_pub.publish(Float32(data=float(self.flow)))
        self.fan_pub.publish(Bool(data=self.running))
        self.yaw_pub.publish(Float32(data=0.35 * math.sin(2.0 * math.pi * self.swing / 60.0)))

    def report(self):
        state = "snow" if self.running else "wait"
        self.status_pub.publish(String(data=f"{state} {self.litres:.0f} l {self.pressure:.1f} bar"))


def main(args=None):
    rclpy.init(args=args)
    gun = SnowGun()
    try:
        rclpy.spin(gun)
    finally:
        gun.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
