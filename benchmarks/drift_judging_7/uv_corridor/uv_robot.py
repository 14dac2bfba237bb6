#!/usr/bin/env python3
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Disinfector(Node):
    """Drive slowly enough for the dose of the handrail; switch the lamp off while a person is near."""

    def __init__(self) -> None:
        super().__init__("uv_robot")
        self.cfg: dict[str, float] = {}
        for key, value in {
            "dose_goal": 60.0,
            "lamp_power": 17.0,
            "strip": 0.9,
            "max_speed": 0.5,
            "pause_near": 1.6,
        }.items():
            self.cfg[key] = self.declare_parameter(key, value).value
        self.person: float = float("inf")
        self.left: float | None = None
        self.cmd = self.create_publisher(Twist, "/cmd_vel", 1)
        self.lamp = self.create_publisher(Bool, "/lamp", 1)
        self.create_subscription(Float64, "/person_distance", self._person, 1)
        self.create_subscription(Float64, "/corridor_left", self._left, 1)
        self.timer = self.create_timer(0.25, self._control)

    def _person(self, msg: Float64) -> None:
        self.person = msg.data

    def _left(self, msg: Float64) -> None:
        self.left = msg.data

    def speed_for_dose(self) -> float:
        exposure = self.cfg["dose_goal"] / self.cfg["lamp_power"]
        return min(self.cfg["max_speed"], self.cfg["strip"] / exposure)

    def _control(self) -> None:
        if self.left is None:
            return
        twist = Twist()
        safe = self.person > self.cfg["pause_near"]
        if safe and self.left > 0.0:
            twist.linear.x = self.speed_for_dose()
        self.lamp.publish(Bool(data=safe))
        self.cmd.publish(twist)


def main() -> None:
    rclpy.init()
    rclpy.spin(Disinfector())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
