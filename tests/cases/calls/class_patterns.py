import rclpy
from dataclasses import dataclass
from rclpy.node import Node
from std_msgs.msg import String, Float32
from geometry_msgs.msg import Twist


@dataclass
class Go:
    speed: float
    turn: float = 0.0


@dataclass
class Halt:
    reason: str


def parse(text):
    match text.split():
        case ["go", speed]:
            return Go(float(speed))
        case ["go", speed, turn]:
            return Go(float(speed), float(turn))
        case ["halt", *why]:
            return Halt(" ".join(why))
        case _:
            return None


class Interpreter(Node):
    def __init__(self):
        super().__init__("interpreter")
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.why = self.create_publisher(String, "why", 10)
        self.con = self.create_publisher(String, "const", 10)
        self.sub = self.create_subscription(String, "command", self.on_command, 10)  # source cmd

    def on_command(self, msg: String):
        t = Twist()
        self.con.publish(String(data="got one"))  # clean
        if (order := parse(msg.data)) is None:
            self.con.publish(String(data="bad"))  # sink ~cmd
            return
        match order:
            case Go(speed=s, turn=w):
                t.linear.x = s
                t.angular.z = w
            case Halt(reason):
                self.why.publish(String(data=reason))  # sink cmd
        self.pub.publish(t)  # sink cmd
        match {"kind": "x", "v": msg.data}:
            case {"kind": "x", "v": v}:
                self.why.publish(String(data=v))  # sink cmd
            case {"kind": k}:
                self.con.publish(String(data=k))  # sink ~cmd


def main():
    rclpy.init()
    rclpy.spin(Interpreter())
