import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Joy, LaserScan


class Safety(Node):
    def __init__(self):
        super().__init__("safety")
        self.cmd = Twist()
        self.near = False
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Joy, "joy", self.on_joy, 10)  # source joy
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)  # source scan
        self.create_timer(0.1, self.tick)

    def on_joy(self, msg):
        self.cmd.linear.x = msg.axes[1]
        self.cmd.angular.z = msg.axes[0]

    def on_scan(self, msg):
        self.near = min(msg.ranges) < 0.3

    def tick(self):
        self.pub.publish(self.cmd)  # sink joy ~scan
        if self.near:
            self.cmd.linear.x = 0.0
            self.pub.publish(self.cmd)  # sink joy ~scan
            self.cmd.angular.z = 0.0
            self.pub.publish(self.cmd)  # sink ~scan

    def stop(self):
        self.cmd.linear.x = 0.0
        self.cmd.angular.z = 0.0
        self.pub.publish(self.cmd)  # clean


def main():
    rclpy.init()
    node = Safety()
    rclpy.spin(node)
    node.stop()
