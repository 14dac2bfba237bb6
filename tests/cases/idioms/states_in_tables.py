"""A state machine as a table of functions keyed by an Enum; transitions return the next state."""

from enum import Enum, IntEnum, auto

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Int32, String, UInt8


class State(Enum):
    SEARCH = auto()
    FOLLOW = auto()
    STOP = auto()


class Level(IntEnum):
    OK = 0
    WARN = 1
    ERROR = 2


class Machine(Node):
    def __init__(self):
        super().__init__("machine")
        self.state = State.SEARCH
        self.side = 1.0
        self.distance = 0.0
        self.steps = 0
        self.handlers = {
            State.SEARCH: self.search,
            State.FOLLOW: self.follow,
            State.STOP: self.stop,
        }
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.state_pub = self.create_publisher(String, "state", 10)
        self.level_pub = self.create_publisher(UInt8, "level", 10)
        self.step_pub = self.create_publisher(Int32, "steps", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)  # source scan
        self.create_subscription(String, "order", self.on_order, 10)  # source order
        self.create_timer(0.1, self.step)

    def on_scan(self, msg):
        half = len(msg.ranges) // 2
        self.distance = min(msg.ranges[:half])

    def on_order(self, msg):
        try:
            self.state = State[msg.data.upper()]
        except KeyError:
            self.get_logger().warn(f"unknown order {msg.data}")

    def search(self, twist):
        twist.angular.z = 0.5
        return State.FOLLOW if self.distance < 2.0 else State.SEARCH

    def follow(self, twist):
        twist.linear.x = 0.3 * self.distance
        if self.distance < 0.3:
            return State.STOP
        return State.FOLLOW

    def stop(self, twist):
        return State.STOP

    def step(self):
        self.steps += 1
        twist = Twist()
        self.state = self.handlers[self.state](twist)
        self.cmd.publish(twist)  # sink scan ~order
        self.state_pub.publish(String(data=self.state.name))  # sink ~scan ~order
        level = Level.ERROR if self.state is State.STOP else Level.OK
        self.level_pub.publish(UInt8(data=int(level)))  # sink ~scan ~order
        self.step_pub.publish(Int32(data=self.steps))  # clean
        self.level_pub.publish(UInt8(data=Level.WARN.value))  # clean


def main():
    rclpy.init()
    rclpy.spin(Machine())


if __name__ == "__main__":
    main()
