#!/usr/bin/env python3
"""Gangway from a ship to a turbine: hold the tip at the landing while the ship heaves."""

import rclpy
from geometry_msgs.msg import Vector3Stamped
from kinematics import PIVOT, luff
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float32

LANDING = 6.8  # height above the water (m)
HYDRAULIC_LAG = 0.30  # time from a command to the motion of the cylinder (s)
RATE_SMOOTHING = 0.7
HOVER = 0.6  # height above the landing before the gangway is lowered (m)
LOWERING = 0.15  # m/s
CALM = 0.9  # heave above which nobody may walk (m/s)
WARM_OIL = 5.0  # °C
DT = 0.1


class GangwayLink(Node):
    def __init__(self):
        super().__init__("gangway_link")
        self.heave, self.rate = None, 0.0
        self.above = HOVER
        self.oil = 20.0
        self.angle = self.create_publisher(Float32, "luff/angle", 10)
        self.light = self.create_publisher(Bool, "light/green", 10)
        self.create_subscription(Vector3Stamped, "mru/heave", self.on_heave, 10)
        self.create_subscription(Temperature, "hydraulics/oil", self.on_oil, 10)
        self.create_timer(DT, self.control)

    def on_heave(self, msg):
        """Keep heave and its rate, which the motion unit sends as y and z."""
        self.heave = msg.vector.y
        self.rate += RATE_SMOOTHING * (msg.vector.z - self.rate)

    def on_oil(self, msg):
        self.oil = msg.temperature
        if self.oil < WARM_OIL:
            self.get_logger().info("the oil is cold", once=True)

    def expected(self):
        """Return the heave at the time when the cylinder has moved."""
        return self.heave + self.rate * HYDRAULIC_LAG

    def lower(self):
        self.above = max(0.0, self.above - LOWERING * DT)
        return self.above

    def control(self):
        if self.heave is None:
            return
        pivot = PIVOT + self.expected()
        height = LANDING + self.lower() - pivot
        self.angle.publish(Float32(data=luff(height)))
        self.light.publish(Bool(data=self.above == 0.0 and abs(self.rate) < CALM))


def main():
    rclpy.init()
    rclpy.spin(GangwayLink())


if __name__ == "__main__":
    main()
