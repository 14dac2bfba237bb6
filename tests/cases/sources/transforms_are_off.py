import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String
from tf2_ros import TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.target = "turtle1"
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.pub = self.create_publisher(Twist, "cmd_vel", 1)
        self.create_subscription(String, "target", self.on_target, 1)  # source target
        self.create_timer(0.1, self.tick)

    def on_target(self, msg):
        self.target = msg.data

    def tick(self):
        cmd = Twist()
        try:
            fixed = self.buffer.lookup_transform("base", "map", rclpy.time.Time())
        except TransformException:
            return
        cmd.linear.x = fixed.transform.translation.x
        self.pub.publish(cmd)  # clean
        there = self.buffer.lookup_transform("base", self.target, rclpy.time.Time())
        cmd.linear.x = there.transform.translation.x
        self.pub.publish(cmd)  # sink target


def main():
    rclpy.init()
    rclpy.spin(Follower())
