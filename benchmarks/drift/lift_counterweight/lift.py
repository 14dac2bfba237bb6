#!/usr/bin/env python3
"""Bring the car of a lift to a floor and hold it there while the doors are open."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, UInt8

FLOOR_HEIGHT = 3.2  # m
TOP_SPEED = 1.2  # m/s


class Lift(Node):
    """Compute the speed from the remaining distance and the force from the speed; both are measured by the encoder."""

    def __init__(self, approach, stiffness, hold, soften=0.8):
        super().__init__("lift")
        self.approach = approach
        self.stiffness = stiffness
        self.hold = hold
        self.soften = soften
        self.goal = None
        self.height = None
        self.before = None
        self.speed = 0.0
        self.create_subscription(UInt8, "/call", self.on_call, 10)
        self.create_subscription(Float64, "/encoder", self.on_encoder, 10)
        self.force = self.create_publisher(Float64, "/force", 10)

    def on_call(self, msg):
        """Store the target floor."""
        self.goal = msg.data * FLOOR_HEIGHT

    def on_encoder(self, msg):
        """Answer the height of the car with a force."""
        self.height = msg.data / 1000.0
        if self.before is not None:
            measured = (self.height - self.before) / 0.05
            self.speed += self.soften * (measured - self.speed)
        self.before = self.height
        if self.goal is not None:
            self.drive()

    def drive(self):
        """Send one force."""
        left = self.goal - self.height
        wanted = self.approach * left
        if wanted > TOP_SPEED:
            wanted = TOP_SPEED
        if wanted < -TOP_SPEED:
            wanted = -TOP_SPEED
        force = self.stiffness * (wanted - self.speed) + self.hold
        self.force.publish(Float64(data=max(-9000.0, min(9000.0, force))))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Lift(approach=0.9, stiffness=3000.0, hold=10.0))


if __name__ == "__main__":
    main()
