import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32
import my_robot.mixing as mx
from my_robot.drivers import Motor, Sonar
from . import params


class Base(Node):
    def __init__(self):
        super().__init__("base")
        self.left, self.right = (Motor(self, s) for s in ("left", "right"))
        self.sonar = Sonar(self, ["front", "rear"], on_change=self.changed)
        self.near = self.create_publisher(Float32, "near", 1)
        self.create_subscription(Twist, "cmd_vel", self.on_cmd, 1)  # source cmd

    def changed(self, topic, value):
        self.near.publish(Float32(data=value))  # sink sonar
        self.near.publish(Float32(data=float(params.MAX)))  # clean

    def on_cmd(self, msg):
        scale = min(1.0, self.sonar.nearest())
        l, r = mx.mix(msg.linear.x * scale, msg.angular.z)
        self.left.set(l)
        self.right.set(r)


def main():
    rclpy.init()
    node = Base()
    rclpy.spin(node)
