"""Several statements compute a constant that a condition chooses, and all of them are under that condition."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Joy, LaserScan
from std_msgs.msg import Int8, String


class Brain(Node):
    def __init__(self):
        super().__init__("brain")
        self.state = "idle"
        self.front = 1.0
        self.light = 0
        self.name = self.create_publisher(String, "name", 1)
        self.cmd = self.create_publisher(Twist, "cmd_vel", 1)
        self.lamp = self.create_publisher(Int8, "lamp", 1)
        self.fixed = self.create_publisher(String, "fixed", 1)
        self.create_subscription(LaserScan, "scan", self.on_scan, 1)  # source scan
        self.create_subscription(Joy, "joy", self.on_joy, 1)  # source joy
        self.create_timer(0.1, self.tick)

    def on_scan(self, msg):
        self.front = min(msg.ranges)  # step ~scan

    def on_joy(self, msg):
        if msg.buttons[0]:  # step ~joy
            self.light = 1 - self.light  # step ~joy
            self.lamp.publish(Int8(data=self.light))  # sink ~joy

    def change(self, state):
        self.state = state  # step ~scan

    def tick(self):
        if self.front < 0.5:  # step ~scan
            self.change("avoid")  # step ~scan
        self.name.publish(String(data=self.state))  # sink ~scan
        twist = Twist()
        if self.front < 0.3:  # step ~scan
            speed = -0.1  # step ~scan
            twist.linear.x = speed  # step ~scan
        self.cmd.publish(twist)  # sink ~scan
        self.fixed.publish(String(data="fixed"))  # clean


rclpy.init()
rclpy.spin(Brain())
