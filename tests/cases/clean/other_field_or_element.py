import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


class Other(Node):
    def __init__(self):
        super().__init__("other")
        self.x = self.y = 0.0
        self.pose = [0.0, 1.0, 2.0]
        self.table = {"x": 0.0, "y": 1.0}
        self.matrix = [[0.0, 0.0], [1.0, 1.0]]
        self.pair = (0.0, 1.0)
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)  # source odom
        self.create_timer(0.1, self.tick)

    def on_odom(self, msg):
        self.x = msg.pose.pose.position.x
        self.pose[0] = msg.pose.pose.position.x
        self.table["x"] = msg.pose.pose.position.x
        self.matrix[0][0] = msg.pose.pose.position.x
        self.pair = (msg.pose.pose.position.x, 2.0)

    def tick(self):
        self.pub.publish(Float64(data=self.x))  # sink odom
        self.pub.publish(Float64(data=self.y))  # clean
        self.pub.publish(Float64(data=self.pose[0]))  # sink odom
        self.pub.publish(Float64(data=self.pose[2]))  # clean
        self.pub.publish(Float64(data=self.pose[-1]))  # clean
        self.pub.publish(Float64(data=self.table["y"]))  # clean
        self.pub.publish(Float64(data=self.table.get("y", 0.0)))  # clean
        self.pub.publish(Float64(data=self.matrix[1][1]))  # clean
        self.pub.publish(Float64(data=self.pair[1]))  # clean
        key = "y"
        self.pub.publish(Float64(data=self.table[key]))  # clean
        self.pub.publish(Float64(data=self.pose[0 + 1]))  # clean
        index = 0
        self.pub.publish(Float64(data=self.pose[index]))  # sink odom


def main():
    rclpy.init()
    rclpy.spin(Other())
