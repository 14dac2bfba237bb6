"""State in dataclasses: properties, `__post_init__`, defaults by factories, `replace` and frozen snapshots."""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, replace

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float64, Float64MultiArray, String


@dataclass(frozen=True)
class Pose2D:
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    @property
    def norm(self) -> float:
        return (self.x**2 + self.y**2) ** 0.5


@dataclass
class RobotState:
    name: str
    pose: Pose2D = field(default_factory=Pose2D)
    goal: Pose2D = field(default_factory=lambda: Pose2D(5.0, 0.0))
    voltage: float | None = None
    trail: list[Pose2D] = field(default_factory=list)
    gain: float = field(init=False)

    def __post_init__(self) -> None:
        self.gain = 0.5 if self.name == "scout" else 1.0

    @property
    def error(self) -> float:
        return self.goal.x - self.pose.x

    @property
    def low(self) -> bool:
        return self.voltage is not None and self.voltage < 11.1


class Driver(Node):
    def __init__(self) -> None:
        super().__init__("driver")
        self.state = RobotState("scout")
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.info = self.create_publisher(Float64, "info", 10)
        self.flat = self.create_publisher(Float64MultiArray, "flat", 10)
        self.text = self.create_publisher(String, "text", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_subscription(BatteryState, "battery", self.on_battery, 10)  # source battery
        self.create_timer(0.1, self.tick)

    def on_odom(self, msg: Odometry) -> None:
        position = msg.pose.pose.position
        self.state.pose = replace(self.state.pose, x=position.x, y=position.y)
        self.state.trail.append(self.state.pose)

    def on_battery(self, msg: BatteryState) -> None:
        self.state.voltage = msg.voltage

    def tick(self) -> None:
        command = Twist()
        command.linear.x = self.state.gain * self.state.error
        if self.state.low:
            command = Twist()
        self.cmd.publish(command)  # sink odom ~battery
        self.info.publish(Float64(data=self.state.pose.norm))  # sink odom
        self.info.publish(Float64(data=self.state.gain))  # clean
        self.info.publish(Float64(data=self.state.goal.norm))  # clean
        self.info.publish(Float64(data=self.state.pose.yaw))  # clean
        self.flat.publish(Float64MultiArray(data=list(astuple(self.state.pose))))  # sink odom
        if self.state.trail:
            self.info.publish(Float64(data=self.state.trail[-1].y))  # sink odom
        self.text.publish(String(data=f"{self.state.name} is up"))  # clean


def main() -> None:
    rclpy.init()
    rclpy.spin(Driver())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
