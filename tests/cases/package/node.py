import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64

from . import limits
from .limits import Controller, clip


class Mixin:
    def on_error(self, msg):
        self.error = msg.data


class Follower(Mixin, Node):
    def __init__(self):
        super().__init__("follower")
        self.error = 0.0
        self.controller = Controller(0.7)
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Float64, "error", self.on_error, 10)  # source error
        self.create_timer(0.1, self.step)

    @property
    def offset(self):
        return self.error - 0.1

    def step(self):
        cmd = Twist()
        cmd.linear.x = limits.TOP
        self.pub.publish(cmd)  # clean
        cmd.angular.z = self.controller.command(self.offset)
        self.pub.publish(cmd)  # sink error
        cmd.angular.z = clip(0.3)
        self.pub.publish(cmd)  # clean


def main(args=None):
    rclpy.init(args=args)
    node = Follower()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
