#!/usr/bin/env python3
"""Ferments yoghurt: heats the milk, holds the temperature for three and a half hours, and cools."""

import math

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String

# Probe: a thermistor, see the plate on its cable
R25 = 10_000.0  # ohm at 25 deg C
BETA = 3977.0  # K
KELVIN = 273.15

PHASES = ("fill", "heat", "culture", "ferment", "cool")


def temperature_of(resistance):
    """Return the temperature in deg C at which the probe has a resistance in ohm."""
    inverse = 1.0 / (25.0 + KELVIN) + math.log(resistance / R25) / BETA
    return 1.0 / inverse - KELVIN


class PI:
    """A PI controller whose integral stops where the output does."""

    def __init__(self, kp, ki, low, high):
        self.kp, self.ki = kp, ki
        self.low, self.high = low, high
        self.integral = 0.0

    def update(self, error, dt):
        raw = self.kp * error + self.integral
        output = min(self.high, max(self.low, raw))
        if output == raw or (raw > self.high) != (error > 0.0):
            self.integral += self.ki * error * dt
        return output

    def reset(self):
        self.integral = 0.0


class YoghurtVat(Node):
    def __init__(self):
        super().__init__("yoghurt_vat")
        self.declare_parameter("ferment_at", 43.0)  # deg C
        self.declare_parameter("ferment_for", 210.0)  # min
        self.declare_parameter("cool_to", 15.0)  # deg C
        self.period = 60.0  # s
        self.heater = PI(kp=0.25, ki=0.0003, low=0.0, high=1.0)
        self.phase = "fill"
        self.phase_start = self.minutes()
        self.temperature = None
        self.bad_readings = 0
        self.heater_pub = self.create_publisher(Float32, "vat/heater", 1)
        self.stirrer_pub = self.create_publisher(Bool, "vat/stirrer", 1)
        self.phase_pub = self.create_publisher(String, "vat/phase", 1)
        self.display_pub = self.create_publisher(Float32, "vat/display", 1)
        self.create_subscription(Float32, "probe/resistance", self.on_probe, 5)
        self.create_subscription(Bool, "vat/filled", self.on_filled, 5)
        self.create_subscription(Bool, "vat/culture_added", self.on_culture, 5)
        self.create_timer(self.period, self.control)

    def minutes(self):
        return self.get_clock().now().nanoseconds / 60e9

    def value(self, name):
        return self.get_parameter(name).value

    def go(self, phase):
        if phase not in PHASES:
            raise ValueError(phase)
        self.get_logger().info(f"{self.phase} -> {phase}")
        self.phase = phase
        self.phase_start = self.minutes()

    def on_probe(self, msg):
        if not 500.0 < msg.data < 60_000.0:
            self.bad_readings += 1
            return
        self.bad_readings = 0
        self.temperature = temperature_of(msg.data)

    def on_filled(self, msg):
        if msg.data and self.phase == "fill":
            self.heater.reset()
            self.go("heat")

    def on_culture(self, msg):
        if msg.data and self.phase == "culture":
            self.go("ferment")

    def advance(self):
        """Go to the next phase when its time has come."""
        goal = self.value("ferment_at")
        if self.phase == "heat" and abs(self.temperature - goal) < 0.8:
            self.go("culture")
        elif self.phase == "ferment" and self.minutes() - self.phase_start >= self.value("ferment_for"):
            self.go("cool")
        elif self.phase == "cool" and self.temperature < self.value("cool_to"):
            self.get_logger().info("cold", once=True)

    def control(self):
        power = 0.0
        if self.temperature is not None and self.bad_readings < 5:
            self.advance()
            if self.phase in ("heat", "culture", "ferment"):
                power = self.heater.update(self.value("ferment_at") - self.temperature, self.period)
            self.display_pub.publish(Float32(data=self.temperature))
        self.heater_pub.publish(Float32(data=float(power)))
        self.stirrer_pub.publish(Bool(data=self.phase in ("heat", "culture")))
        self.phase_pub.publish(String(data=self.phase))


def main():
    rclpy.init()
    rclpy.spin(YoghurtVat())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
