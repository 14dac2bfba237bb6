import dataclasses

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String


@dataclasses.dataclass(frozen=True)
class Command:
    speed: float = 0.0
    turn: float = 0.0
    note: str = ""


class Replace(Node):
    def __init__(self):
        super().__init__("replace")
        self.command = Command(turn=0.2)
        self.text = "speed=<v>"
        self.pub = self.create_publisher(Float64, "out", 10)
        self.label = self.create_publisher(String, "label", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value
        self.create_subscription(String, "name", self.on_name, 10)  # source name

    def on_in(self, msg):
        command = dataclasses.replace(self.command, speed=msg.data)
        self.pub.publish(Float64(data=command.speed))  # sink value
        self.pub.publish(Float64(data=command.turn))  # clean
        self.pub.publish(Float64(data=self.command.speed))  # clean
        self.label.publish(String(data=self.text.replace("<v>", str(msg.data))))  # sink value
        self.label.publish(String(data=self.text.replace("<v>", "none")))  # clean

    def on_name(self, msg):
        name = msg.data.replace(" ", "_").lower()
        self.label.publish(String(data=name))  # sink name
        self.label.publish(String(data="fixed".upper()))  # clean


def main():
    rclpy.init()
    rclpy.spin(Replace())
