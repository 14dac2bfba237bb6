#!/usr/bin/env python3
"""Keeps an air dome over tennis courts up: a blower holds its pressure, also while the vehicle gate is open."""

from collections import deque
from enum import Enum

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Bool, Float32, String

TARGET = 250.0  # Pa over the air outside
GATE_EXTRA = 40.0  # Pa, while the gate is open
IDLE_DUTY = 0.25  # of the blower, below which its flap flutters
KP = 0.0025  # duty per Pa
KI = 0.0004
ALARM = 120.0  # Pa


class Mode(Enum):
    INFLATE = "inflate"
    HOLD = "hold"
    GATE = "gate"


class AirDome(Node):
    PERIOD = 2.0

    def __init__(self):
        super().__init__("air_dome")
        self.mode = Mode.INFLATE
        self.readings = deque(maxlen=3)
        self.wind = deque(maxlen=30)
        self.gate_open = False
        self.integral = 0.3
        self.alarms = 0
        self.blower = self.create_publisher(Float32, "blower/duty", 1)
        self.status = self.create_publisher(String, "dome/status", 1)
        self.create_subscription(FluidPressure, "dome/pressure", self.pressure_cb, 5)
        self.create_subscription(Float32, "mast/wind", self.wind_cb, 5)
        self.create_subscription(Bool, "gate/open", self.gate_cb, 1)
        self.create_timer(self.PERIOD, self.control)
        self.create_timer(60.0, self.log)

    def pressure_cb(self, msg):
        self.readings.append(msg.fluid_pressure)

    def wind_cb(self, msg):
        self.wind.append(msg.data)

    def gate_cb(self, msg):
        self.gate_open = msg.data

    def pressure(self):
        """Return the median of the last readings."""
        return sorted(self.readings)[len(self.readings) // 2]

    def mean_wind(self):
        return sum(self.wind) / len(self.wind) if self.wind else 0.0

    def choose(self, pressure):
        if self.mode is Mode.INFLATE and pressure < 0.9 * TARGET:
            return Mode.INFLATE
        return Mode.GATE if self.gate_open else Mode.HOLD

    def wanted(self):
        extra = GATE_EXTRA if self.mode is Mode.GATE else 0.0
        return TARGET + extra

    def duty(self, pressure):
        error = self.wanted() - pressure
        self.integral = max(0.0, min(0.9, self.integral + KI * error * self.PERIOD))
        return max(IDLE_DUTY, min(1.0, self.integral + KP * error))

    def control(self):
        if not self.readings:
            return
        pressure = self.pressure()
        mode = self.choose(pressure)
        if mode is not self.mode:
            self.get_logger().info(f"{self.mode.value} -> {mode.value} at {pressure:.0f} Pa")
            self.mode = mode
        duty = 1.0 if mode is Mode.INFLATE else self.duty(pressure)
        if mode is not Mode.INFLATE and pressure < ALARM:
            self.alarms += 1
            self.status.publish(String(data="alarm"))
        else:
            self.status.publish(String(data=mode.value))
        self.blower.publish(Float32(data=duty))

    def log(self):
        if self.readings:
            self.get_logger().info(
                f"{self.pressure():.0f} Pa, wind {self.mean_wind():.1f} m/s, {self.alarms} alarms"
            )


def main():
    rclpy.init()
    dome = AirDome()
    try:
        rclpy.spin(dome)
    finally:
        dome.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
