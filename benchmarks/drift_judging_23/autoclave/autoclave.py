#!/usr/bin/env python3
"""Steam steriliser of a mobile clinic: drives out the air, heats, holds, and blows off the steam.

The pressure sensor is a gauge, so it reads zero while the door is open. The chamber has no thermometer of its own.
"""

from dataclasses import dataclass
from enum import Enum

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Bool, Float32, String
from steam import pressure_at, temperature_at

ATMOSPHERE = 1.013  # bar
PASCAL = 1e-5  # bar


@dataclass(frozen=True)
class Program:
    celsius: float
    hold: float  # s
    pulses: int  # with which steam drives the air out


PROGRAMS = {
    "wrapped": Program(134.5, 240.0, 3),
    "unwrapped": Program(134.5, 210.0, 1),
    "rubber": Program(121.5, 960.0, 3),
}


class Phase(Enum):
    IDLE = "idle"
    PURGE = "purge"
    HEAT = "heat"
    HOLD = "hold"
    EXHAUST = "exhaust"
    DONE = "done"


class Autoclave(Node):
    def __init__(self):
        super().__init__("autoclave")
        self.program = PROGRAMS[self.declare_parameter("program", "wrapped").value]
        self.kp = self.declare_parameter("kp", 2.4).value  # duty per bar
        self.ki = self.declare_parameter("ki", 0.03).value
        self.purge_low = self.declare_parameter("purge_low", 0.15).value  # bar
        self.purge_high = self.declare_parameter("purge_high", 0.7).value
        self.band = self.declare_parameter(
            "band", 0.04
        ).value  # bar below the target in which the hold begins
        self.phase = Phase.IDLE
        self.since = 0.0
        self.gauge = 0.0
        self.pulses = 0
        self.venting = False
        self.integral = 0.0
        self.weather = None
        self.heater = self.create_publisher(Float32, "heater/duty", 1)
        self.valve = self.create_publisher(Bool, "valve/open", 1)
        self.report = self.create_publisher(String, "autoclave/phase", 1)
        self.create_subscription(FluidPressure, "chamber/gauge", self.gauge_cb, 5)
        self.create_subscription(FluidPressure, "clinic/barometer", self.barometer_cb, 1)
        self.create_subscription(Bool, "door/locked", self.door_cb, 1)
        self.create_timer(2.0, self.control)

    def gauge_cb(self, msg):
        self.gauge = msg.fluid_pressure * PASCAL

    def barometer_cb(self, msg):
        self.weather = msg.fluid_pressure * PASCAL

    def door_cb(self, msg):
        if msg.data and self.phase is Phase.IDLE:
            self.get_logger().info(f"start at {self.weather or 0.0:.3f} bar outside")
            self.enter(Phase.PURGE)

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def enter(self, phase):
        self.phase = phase
        self.since = self.now()

    def target(self):
        """Return the pressure that the gauge must read."""
        return pressure_at(self.program.celsius) - ATMOSPHERE

    def duty(self, wanted):
        error = wanted - self.gauge
        if abs(error) < 0.3:
            self.integral = max(0.0, min(0.6, self.integral + self.ki * error * 2.0))
        return max(0.0, min(1.0, self.kp * error + self.integral))

    def purge(self):
        if self.venting and self.gauge < self.purge_low:
            self.venting = False
            self.pulses += 1
        elif not self.venting and self.gauge > self.purge_high:
            self.venting = True
        if self.pulses >= self.program.pulses and not self.venting:
            self.enter(Phase.HEAT)

    def control(self):
        duty = 0.0
        if self.phase is Phase.PURGE:
            self.purge()
            duty = 0.0 if self.venting else 1.0
        elif self.phase is Phase.HEAT:
            duty = self.duty(self.target())
            if self.gauge > self.target() - self.band:
                self.get_logger().info(f"{temperature_at(self.gauge + ATMOSPHERE):.1f} degrees")
                self.enter(Phase.HOLD)
        elif self.phase is Phase.HOLD:
            duty = self.duty(self.target())
            if self.now() - self.since > self.program.hold:
                self.venting = True
                self.enter(Phase.EXHAUST)
        elif self.phase is Phase.EXHAUST and self.gauge < 0.03:
            self.enter(Phase.DONE)
        self.heater.publish(Float32(data=duty))
        self.valve.publish(Bool(data=self.venting))
        self.report.publish(String(data=self.phase.value))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Autoclave())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
