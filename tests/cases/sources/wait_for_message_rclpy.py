import rclpy
from rclpy.node import Node
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Float64


class Starter(Node):
    def __init__(self):
        super().__init__("starter")
        self.pub = self.create_publisher(Float64, "out", 1)

    def run(self):
        ok, msg = wait_for_message(Float64, self, "first", time_to_wait=5.0)  # source first
        if ok:
            self.pub.publish(msg)  # sink first
        self.pub.publish(Float64(data=1.0))  # clean


def main():
    rclpy.init()
    Starter().run()
    rclpy.shutdown()
