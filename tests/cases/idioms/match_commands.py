"""`match` on words, sequences, classes and mappings."""

from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64, String


@dataclass
class Move:
    distance: float


@dataclass
class Turn:
    angle: float


def parse(text):
    match text.split():
        case ["move", amount]:
            return Move(float(amount))
        case ["turn", amount, *_]:
            return Turn(float(amount))
        case []:
            return None
        case _:
            return "unknown"


class Commander(Node):
    def __init__(self):
        super().__init__("commander")
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.left = self.create_publisher(Float64, "left", 10)
        self.answer = self.create_publisher(String, "answer", 10)
        self.version = self.create_publisher(String, "version", 10)
        self.create_subscription(String, "command", self.on_command, 10)  # source command
        self.create_subscription(String, "mode", self.on_mode, 10)  # source mode
        self.factor = 1.0
        self.version.publish(String(data="1.0"))  # clean

    def on_mode(self, msg):
        match msg.data:
            case "slow" | "careful":
                self.factor = 0.5
            case "fast" if self.get_parameter_or("unlocked", None):
                self.factor = 2.0
            case _:
                pass

    def on_command(self, msg):
        twist = Twist()
        match parse(msg.data):
            case Move(distance=d) if d > 0:
                twist.linear.x = self.factor * d
                self.left.publish(Float64(data=d))  # sink command
            case Move(d):
                twist.linear.x = -0.1
            case Turn(angle):
                twist.angular.z = angle
            case None:
                return
            case str() as other:
                self.answer.publish(String(data=other))  # sink ~command
                return
        self.cmd.publish(twist)  # sink command ~mode
        self.report({"kind": "version", "number": 3})

    def report(self, entry):
        match entry:
            case {"kind": "version", "number": number}:
                self.version.publish(String(data=str(number)))  # sink ~command


def main():
    rclpy.init()
    rclpy.spin(Commander())


if __name__ == "__main__":
    main()
