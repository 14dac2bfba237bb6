#!/usr/bin/env python3
"""Wind machine of an orchard: on frosty nights, it mixes warm air above the trees with the cold air between them.

The engine warms up at idle first, and cools down at idle before it stops.
"""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float32, String

OFF, WARM_UP, FAN, COOL_DOWN = "off", "warm up", "fan", "cool down"


class Average:
    """Mean of the last readings."""

    def __init__(self, size):
        self.size = size
        self.values = []

    def add(self, value):
        self.values.append(value)
        del self.values[: -self.size]

    def mean(self):
        return sum(self.values) / len(self.values) if self.values else None


class FrostFan(Node):
    def __init__(self):
        super().__init__("frost_fan")
        self.declare_parameters(
            "",
            [
                ("start_below", 0.8),  # degrees
                ("stop_above", 5.0),
                ("warm_up", 480.0),  # s
                ("cool_down", 300.0),
                ("min_run", 1800.0),
                ("idle_rpm", 800.0),
                ("fan_rpm", 2300.0),
                ("max_wind", 4.0),  # m/s; in more, the air mixes by itself
            ],
        )
        self.state = OFF
        self.since = self.seconds()
        self.air = Average(3)
        self.dew = Average(3)
        self.wind = 0.0
        self.armed = False
        self.starts = 0
        self.rpm_pub = self.create_publisher(Float32, "engine/rpm", 1)
        self.state_pub = self.create_publisher(String, "fan/state", 1)
        self.create_subscription(Temperature, "orchard/air", lambda msg: self.air.add(msg.temperature), 1)
        self.create_subscription(
            Temperature, "orchard/dew_point", lambda msg: self.dew.add(msg.temperature), 1
        )
        self.create_subscription(Float32, "orchard/wind", self.wind_cb, 1)
        self.create_subscription(Bool, "orchard/arm", self.arm_cb, 1)
        self.create_timer(120.0, self.update)

    def param(self, name):
        return self.get_parameter(name).value

    def seconds(self):
        return self.get_clock().now().nanoseconds / 1e9

    def wind_cb(self, msg):
        self.wind = msg.data

    def arm_cb(self, msg):
        self.armed = msg.data

    def to(self, state):
        air, dew = self.air.mean(), self.dew.mean()
        self.get_logger().info(f"{self.state} -> {state} at {air:.1f} degrees, dew point {dew or 0.0:.1f}")
        self.state = state
        self.since = self.seconds()

    def update(self):
        air = self.air.mean()
        if air is None:
            return
        elapsed = self.seconds() - self.since
        if self.state == OFF:
            if self.armed and air < self.param("start_below") and self.wind < self.param("max_wind"):
                self.starts += 1
                self.to(WARM_UP)
        elif self.state == WARM_UP:
            if elapsed >= self.param("warm_up"):
                self.to(FAN)
        elif self.state == FAN:
            too_warm = air > self.param("stop_above")
            if elapsed >= self.param("min_run") and (too_warm or self.wind > self.param("max_wind")):
                self.to(COOL_DOWN)
        elif elapsed >= self.param("cool_down"):
            self.to(OFF)
        rpm = {OFF: 0.0, FAN: self.param("fan_rpm")}.get(self.state, self.param("idle_rpm"))
        self.rpm_pub.publish(Float32(data=rpm))
        self.state_pub.publish(String(data=self.state))


def main(args=None):
    rclpy.init(args=args)
    node = FrostFan()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == "__main__":
    main()
