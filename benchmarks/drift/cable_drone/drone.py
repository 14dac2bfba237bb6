#!/usr/bin/env python3
"""Hold a cable drone in front of a wall while it inspects it."""

import rclpy
from geometry_msgs.msg import PointStamped, Vector3
from rclpy.node import Node
from std_msgs.msg import Float32

PLACE = (0.0, 2.0, 5.0)  # place to hold (m)
STIFFNESS = {"x": 3.0, "y": 3.5, "z": 4.0}  # N/m
DAMPING = {"x": 3.5, "y": 3.5, "z": 4.0}  # N s/m
MOST = 12.0  # N


def bounded(force):
    """Limit a force to the range of the winches."""
    if force > MOST:
        return MOST
    if force < -MOST:
        return -MOST
    return force


class CableDrone(Node):
    """Control each axis by the same law with separate gains."""

    def __init__(self):
        super().__init__("cable_drone")
        self.x, self.y, self.z = PLACE
        self.vx = self.vy = self.vz = 0.0
        self.create_subscription(PointStamped, "/place", self.on_place, 10)
        self.force = self.create_publisher(Vector3, "/force", 10)
        self.zoom = self.create_publisher(Float32, "/zoom", 10)
        self.create_timer(0.1, self.on_timer)

    def on_place(self, msg):
        """Store the position and the speed of the drone."""
        self.vx = 0.5 * self.vx + 0.5 * (msg.point.x - self.x) / 0.1
        self.vy = 0.5 * self.vy + 0.5 * (msg.point.y - self.y) / 0.1
        self.vz = 0.5 * self.vz + 0.5 * (msg.point.z - self.z) / 0.1
        self.x = msg.point.x
        self.y = msg.point.y
        self.z = msg.point.z

    def on_timer(self):
        """Send one force."""
        force = Vector3()
        force.x = bounded(STIFFNESS["x"] * (PLACE[0] - self.x) - DAMPING["x"] * self.vx)
        force.y = bounded(STIFFNESS["y"] * (PLACE[1] - self.y) - DAMPING["y"] * self.vy)
        force.z = bounded(STIFFNESS["z"] * (PLACE[2] - self.z) - DAMPING["z"] * self.vz)
        self.force.publish(force)
        self.zoom.publish(Float32(data=1.0 + 0.2 * abs(self.y - PLACE[1])))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(CableDrone())


if __name__ == "__main__":
    main()
