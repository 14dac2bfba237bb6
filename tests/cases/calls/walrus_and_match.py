from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String


@dataclass
class Move:
    speed: float
    turn: float = 0.0


class Commands(Node):
    def __init__(self):
        super().__init__("commands")
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(String, "command", self.on_command, 10)  # source command
        self.create_subscription(Float64, "value", self.on_value, 10)  # source value

    def on_command(self, msg):
        match msg.data.split():
            case ["go", speed]:
                self.pub.publish(Float64(data=float(speed)))  # sink command
            case ["stop"]:
                self.pub.publish(Float64(data=0.0))  # sink ~command
            case [first, *rest] if len(rest) > 2:
                self.pub.publish(Float64(data=float(rest[0])))  # sink command
            case _:
                self.pub.publish(Float64(data=-1.0))  # sink ~command
        self.pub.publish(Float64(data=9.0))  # clean

    def on_value(self, msg):
        if (value := abs(msg.data)) > 1.0:
            self.pub.publish(Float64(data=value))  # sink value
        while (left := value - 1.0) > 0.0:
            self.pub.publish(Float64(data=left))  # sink value
            break
        print(fixed := 3.0)
        self.pub.publish(Float64(data=fixed))  # clean
        match Move(msg.data, 2.0):
            case Move(speed=s, turn=t):
                self.pub.publish(Float64(data=s))  # sink value
                self.pub.publish(Float64(data=t))  # clean
        match {"speed": msg.data, "limit": 1.0}:
            case {"speed": speed, "limit": limit}:
                self.pub.publish(Float64(data=speed))  # sink value
                self.pub.publish(Float64(data=limit))  # clean
        match (msg.data, 5.0):
            case (a, b):
                self.pub.publish(Float64(data=a))  # sink value
                self.pub.publish(Float64(data=b))  # clean


def main():
    rclpy.init()
    rclpy.spin(Commands())
