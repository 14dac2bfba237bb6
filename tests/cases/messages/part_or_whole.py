import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Guard(Node):
    """A node publishes a message unchanged, or one number of it in a new message."""

    def __init__(self):
        super().__init__("guard")
        self.wish = Twist()
        self.ranges = []
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.scanned, 10)  # source scan
        self.create_subscription(Twist, "wish", self.wished, 10)  # source wish
        self.ready = self.create_publisher(Twist, "ready", 10)
        self.create_timer(0.1, self.decide)

    def scanned(self, msg):
        self.ranges = msg.ranges  # step ~scan

    def wished(self, msg):
        self.wish = msg  # step wish

    def decide(self):
        twist = Twist()
        if min(self.ranges) < 0.3:  # step ~scan
            twist.linear.x = 0.0  # step ~scan
            twist.angular.z = self.wish.angular.z  # step wish ~scan
        else:
            twist = self.wish  # step wish ~scan
        self.pub.publish(twist)  # sink wish ~scan
        self.ready.publish(Twist())  # clean


rclpy.init()
rclpy.spin(Guard())
