#!/usr/bin/env python3
"""Bakes bread in a deck oven: steam at first, then falling heat, and out when the core is hot enough."""

from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String


@dataclass
class Program:
    """Oven temperatures in deg C at times in min, between which the oven interpolates."""

    curve: tuple = ((0.0, 245.0), (8.0, 240.0), (20.0, 215.0), (35.0, 200.0), (60.0, 195.0))
    steam_until: float = 10.0  # min
    core_done: float = 93.0  # deg C
    longest: float = 75.0  # min

    def oven_at(self, minutes):
        """Return the temperature of the oven at a time."""
        before = self.curve[0]
        for point in self.curve[1:]:
            if minutes < point[0]:
                share = (minutes - before[0]) / (point[0] - before[0])
                return before[1] + share * (point[1] - before[1])
            before = point
        return before[1]


class Median3:
    """The median of the last three values."""

    def __init__(self):
        self.values = []

    def __call__(self, value):
        self.values = [*self.values[-2:], value]
        return sorted(self.values)[len(self.values) // 2]


class LoafBaker(Node):
    def __init__(self):
        super().__init__("loaf_baker")
        self.program = Program()
        self.heat_gain = self.declare_parameter("heat_gain", 0.04).value
        self.deck = None
        self.core = None
        self.median = Median3()
        self.began = None
        self.state = "empty"
        self.heater_pub = self.create_publisher(Float32, "oven/heater", 1)
        self.steam_pub = self.create_publisher(Bool, "oven/steam", 1)
        self.state_pub = self.create_publisher(String, "baker/state", 1)
        self.info_pub = self.create_publisher(String, "baker/info", 1)
        self.create_subscription(Float32, "oven/deck", self.on_deck, 5)
        self.create_subscription(Float32, "probe/core", self.on_core, 5)
        self.create_subscription(Bool, "oven/loaded", self.on_loaded, 5)
        self.create_timer(15.0, self.tick)

    def minutes(self):
        """Return the minutes since the loaf went in."""
        return (self.get_clock().now() - self.began).nanoseconds / 60e9

    def on_deck(self, msg):
        self.deck = msg.data

    def on_core(self, msg):
        if 0.0 < msg.data < 130.0:
            self.core = self.median(msg.data)

    def on_loaded(self, msg):
        if msg.data and self.state == "empty":
            self.began = self.get_clock().now()
            self.state = "bake"
        elif not msg.data and self.state == "out":
            self.state = "empty"

    def baked(self):
        """Return whether the crumb is done."""
        return self.core is not None and self.core >= self.program.core_done

    def heat(self, goal):
        """Return the share of the heater's power."""
        return max(0.0, min(1.0, 0.3 + self.heat_gain * (goal - self.deck)))

    def tick(self):
        power, steam = 0.0, False
        if self.deck is not None:
            if self.state == "bake":
                minutes = self.minutes()
                power = self.heat(self.program.oven_at(minutes))
                steam = minutes < self.program.steam_until
                if self.baked() or minutes > self.program.longest:
                    self.state = "out"
                    core = -1.0 if self.core is None else self.core
                    self.info_pub.publish(String(data=f"out after {minutes:.0f} min, core {core:.1f} deg C"))
            else:
                power = self.heat(self.program.curve[0][1])
        self.heater_pub.publish(Float32(data=float(power)))
        self.steam_pub.publish(Bool(data=steam))
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(LoafBaker())
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
