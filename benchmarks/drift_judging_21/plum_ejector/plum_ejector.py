#!/usr/bin/env python3
"""Ejector of a fruit grader: blows fruit that the camera finds too soft off the belt, with one air jet per lane."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Float32, Float32MultiArray, String

RECIPES = {  # softness from which a fruit is ejected, and s of air for it
    "apricot": {"soft": 0.48, "pulse": 0.019},
    "plum": {"soft": 0.55, "pulse": 0.024},
    "peach": {"soft": 0.60, "pulse": 0.041},
}
JET_DISTANCE = 0.42  # m from the line of the camera to the jets
LOW_AIR = 3.5e5  # Pa


class PlumEjector(Node):
    def __init__(self):
        super().__init__("plum_ejector")
        fruit = self.declare_parameter("fruit", "plum").value
        self.recipe = RECIPES[fruit]
        self.belt = None
        self.air = None
        self.seen = 0
        self.ejected = 0
        self.valves = self.create_publisher(Float32MultiArray, "valves/fire", 10)
        self.status = self.create_publisher(String, "grader/status", 1)
        self.create_subscription(Float32, "belt/speed", self.on_belt, 10)
        self.create_subscription(FluidPressure, "air/pressure", self.on_air, 10)
        self.create_subscription(Float32MultiArray, "camera/fruit", self.on_fruit, 20)
        self.create_timer(1.0, self.report)

    def on_belt(self, msg):
        self.belt = msg.data

    def on_air(self, msg):
        self.air = msg.fluid_pressure

    def on_fruit(self, msg):
        """One fruit under the camera: [lane, softness]."""
        if not self.belt:
            return
        lane, softness = msg.data[0], msg.data[1]
        self.seen += 1
        if softness >= self.recipe["soft"]:
            self.eject(lane)

    def eject(self, lane):
        delay = JET_DISTANCE / self.belt
        self.valves.publish(Float32MultiArray(data=[lane, delay, self.recipe["pulse"]]))
        self.ejected += 1

    def report(self):
        state = "low air" if self.air is not None and self.air < LOW_AIR else "ok"
        self.status.publish(String(data=f"{state}: {self.ejected} of {self.seen}"))


def main():
    rclpy.init()
    node = PlumEjector()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
