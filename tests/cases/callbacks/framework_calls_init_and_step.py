"""Plugins of simulators: classes without a base, whose `init` and `step` the simulator calls."""

import rclpy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Range
from std_msgs.msg import Float64


class Driver:
    def init(self, webots_node, properties):
        self.robot = webots_node.robot
        self.motor = self.robot.getDevice("motor")
        self.target = Twist()
        self.near = 0.0
        rclpy.init(args=None)
        self.node = rclpy.create_node("driver")
        self.node.create_subscription(Twist, "cmd_vel", self.on_command, 1)  # source command
        self.node.create_subscription(Range, "range", self.on_range, 1)  # source range
        self.speed = self.node.create_publisher(Float64, "speed", 1)
        self.alarm = self.node.create_publisher(Float64, "alarm", 1)
        self.alive = self.node.create_publisher(Float64, "alive", 1)

    def on_command(self, msg):
        self.target = msg

    def on_range(self, msg):
        self.near = msg.range

    def step(self):
        rclpy.spin_once(self.node, timeout_sec=0)
        self.speed.publish(Float64(data=self.target.linear.x))  # sink command
        if self.near < 0.1:
            self.alarm.publish(Float64(data=1.0))  # sink ~range
        self.alive.publish(Float64(data=self.robot.getTime()))  # clean


class Helper:
    """Not a plugin: it registers its callbacks in its constructor, and nothing calls its other methods."""

    def __init__(self):
        self.node = rclpy.create_node("helper")
        self.value = 0.0
        self.out = self.node.create_publisher(Float64, "out", 1)
        self.node.create_subscription(Float64, "value", self.on_value, 1)  # source value

    def on_value(self, msg):
        self.value = msg.data
        self.out.publish(Float64(data=self.value))  # sink value
