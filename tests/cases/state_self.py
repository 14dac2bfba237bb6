import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64


class Arm:
    def __init__(self, gain=1.0):
        self.gain = gain
        self.angle = 0.0
        self.limit = 2.0


class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        self.arm = Arm(gain=0.4)
        self.other = Arm()
        self.cmd = Twist()
        self.scan = None
        self.near = False
        self.log = {}
        self.history = []
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.raw = self.create_publisher(Float64, "raw", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)  # source scan
        self.create_timer(0.1, self.on_timer)

    def on_odom(self, msg):
        self.arm.angle = msg.pose.pose.orientation.z
        self.log["x"] = msg.pose.pose.position.x
        self.log["fixed"] = 4.0
        self.history.append(msg.twist.twist.linear.x)

    def on_scan(self, msg):
        self.scan = msg
        self.near = True

    def on_timer(self):
        self.raw.publish(self.arm.angle * self.arm.gain)  # sink odom
        self.raw.publish(self.other.angle)  # clean
        self.raw.publish(self.arm.limit)  # clean
        self.raw.publish(self.log["x"])  # sink odom
        self.raw.publish(self.log["fixed"])  # clean
        self.raw.publish(sum(self.history) / len(self.history))  # sink odom
        if self.near:
            self.raw.publish(7.0)  # clean
        if self.scan is None:
            return
        self.cmd.linear.x = min(self.scan.ranges)
        self.pub.publish(self.cmd)  # sink scan
        self.cmd.linear.x = 0.0
        self.pub.publish(self.cmd)  # clean
        cmd = self.cmd
        cmd.angular.z = self.scan.angle_min
        self.pub.publish(self.cmd)  # sink scan
        cmd.angular.z = 0.0


def main():
    rclpy.init()
    rclpy.spin(Keeper())
