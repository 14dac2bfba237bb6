#!/usr/bin/env python3
"""Keeps the battery pack of an outdoor robot warm in winter: a heating mat behind a relay, and a small fan."""

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, Temperature
from std_msgs.msg import Bool, Float32, String

LOW_CELL = 3.25
CELLS = 12


class PackWarmer(Node):
    def __init__(self):
        super().__init__("pack_warmer")
        p = self.declare_parameters(
            "",
            [
                ("setpoint", 15.0),
                ("too_hot", 38.0),
                ("plausible_low", -30.0),
                ("plausible_high", 70.0),
                ("fan_above", 32.0),
                ("mat_offset", 0.0),
            ],
        )
        self.cfg = {q.name: q.value for q in p}
        self.heating = False
        self.fault = ""
        self.volts = 3.7 * CELLS
        self.bad = 0
        self.relay = self.create_publisher(Bool, "mat/relay", 1)
        self.fan = self.create_publisher(Float32, "fan/duty", 1)
        self.diag = self.create_publisher(String, "warmer/diag", 1)
        self.create_subscription(
            Temperature, "pack/temperature", self.on_temperature, qos_profile_sensor_data
        )
        self.create_subscription(BatteryState, "battery", self.on_battery, 10)

    def on_battery(self, msg):
        self.volts = 0.8 * self.volts + 0.2 * msg.voltage

    def on_temperature(self, msg):
        t = msg.temperature + self.cfg["mat_offset"]
        if not self.cfg["plausible_low"] < t < self.cfg["plausible_high"]:
            self.bad += 1
            if self.bad > 5:
                self.fault = "sensor"
                self.switch(False)
            return
        self.bad = 0
        if self.volts < LOW_CELL * CELLS or t > self.cfg["too_hot"]:
            self.switch(False)
        elif t < self.cfg["setpoint"]:
            self.switch(True)
        else:
            self.switch(False)
        self.fan.publish(Float32(data=self.fan_duty(t)))

    def fan_duty(self, t):
        over = t - self.cfg["fan_above"]
        if over <= 0.0:
            return 0.15 if self.heating else 0.0
        return min(1.0, 0.3 + 0.1 * over)

    def switch(self, on):
        self.heating = on
        self.relay.publish(Bool(data=on))
        self.diag.publish(String(data=self.fault or ("heating" if on else "off")))


def main():
    rclpy.init()
    warmer = PackWarmer()
    try:
        rclpy.spin(warmer)
    except KeyboardInterrupt:
        pass
    rclpy.shutdown()


if __name__ == "__main__":
    main()
