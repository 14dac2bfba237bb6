#!/usr/bin/env python3
"""Drive a serving robot along the aisle of a restaurant to the table of an order."""

import rclpy
from geometry_msgs.msg import Pose2D, Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Waiter(Node):
    """Serve one table at a time."""

    CRUISE_SPEED = 0.9  # m/s
    DOOR_SPEED = 0.45  # speed next to the kitchen door (m/s)
    APPROACH_GAIN = 0.8  # 1/s
    MIN_SPEED = 0.08  # the wheels stick at lower speeds (m/s)
    TOLERANCE = 0.05  # m
    LANE_GAIN = 1.2  # 1/s per m

    def __init__(self):
        super().__init__("waiter")
        self.declare_parameter("rate_hz", 10.0)
        self._table = None
        self._x = None
        self._y = 0.0
        self._at_door = False
        self._cmd_pub = self.create_publisher(Twist, "cmd_vel", 10)
        self._arrived_pub = self.create_publisher(Bool, "arrived", 10)
        self.create_subscription(Pose2D, "pose", self._on_pose, 10)
        self.create_subscription(Float64, "table", self._on_table, 10)
        self.create_subscription(Bool, "door_zone", self._on_door_zone, 10)
        self.create_timer(1.0 / self.get_parameter("rate_hz").value, self._control)

    def _on_pose(self, msg: Pose2D) -> None:
        self._x = msg.x
        self._y = msg.y

    def _on_table(self, msg: Float64) -> None:
        self._table = msg.data

    def _on_door_zone(self, msg: Bool) -> None:
        self._at_door = msg.data

    def _speed_for(self, remaining: float) -> float:
        limit = self.DOOR_SPEED if self._at_door else self.CRUISE_SPEED
        return max(self.MIN_SPEED, min(limit, self.APPROACH_GAIN * remaining))

    def _control(self) -> None:
        if self._table is None or self._x is None:
            return
        remaining = self._table - self._x
        cmd = Twist()
        if remaining < self.TOLERANCE:
            self._cmd_pub.publish(cmd)
            self._arrived_pub.publish(Bool(data=True))
            return
        cmd.linear.x = self._speed_for(remaining)
        cmd.angular.z = -self.LANE_GAIN * self._y
        self._cmd_pub.publish(cmd)


def main() -> None:
    """Entry point."""
    rclpy.init()
    rclpy.spin(Waiter())


if __name__ == "__main__":
    main()
