#!/usr/bin/env python3
"""Hold and move an elbow by a gravity model, which supplies most of the torque, and a soft controller."""

import math

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

MODEL = {
    "forearm": 1.4,  # kg
    "hand": 0.4,  # kg
    "length": 0.35,  # m
    "friction": 0.05,  # N m
}


class Elbow(Node):
    """Answer every joint state with a torque."""

    KP = 6.0
    KD = 1.2
    MOST = 15.0

    def __init__(self):
        super().__init__("elbow")
        self.goal = 0.0
        self.command = self.create_publisher(Float64, "/torque", 10)
        self.create_subscription(Float64, "/goal", self.on_goal, 10)
        self.create_subscription(JointState, "/joint", self.on_joint, 10)

    def on_goal(self, msg):
        """Store the target angle, rad above the horizon."""
        self.goal += 0.2 * (msg.data - self.goal)

    def gravity(self, angle):
        """Return the torque that compensates gravity."""
        mass = 0.5 * MODEL["forearm"] + MODEL["hand"]
        return mass * 9.81 * MODEL["length"] * math.cos(angle)

    def on_joint(self, msg):
        """Send a torque computed from angle and speed."""
        angle = msg.position[0]
        speed = msg.velocity[0]
        error = self.goal - angle
        torque = self.KP * error - self.KD * speed
        torque += self.gravity(angle)
        if speed > 0.02:
            torque += MODEL["friction"]
        elif speed < -0.02:
            torque -= MODEL["friction"]
        self.command.publish(Float64(data=max(-self.MOST, min(self.MOST, torque))))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Elbow())


if __name__ == "__main__":
    main()
