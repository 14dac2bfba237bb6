import rclpy
from message_filters import ApproximateTimeSynchronizer, Subscriber, TimeSynchronizer
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image, Imu
from std_msgs.msg import Float64


class Stereo(Node):
    def __init__(self):
        super().__init__("stereo")
        self.pub = self.create_publisher(Float64, "out", 10)
        self.left = Subscriber(self, Image, "left")  # source left
        self.right = Subscriber(self, Image, "right")  # source right
        self.sync = ApproximateTimeSynchronizer([self.left, self.right], queue_size=5, slop=0.1)
        self.sync.registerCallback(self.on_pair)
        subs = []
        for topic in ("a", "b"):
            subs.append(Subscriber(self, Imu, topic))  # source imu
        exact = TimeSynchronizer(subs, 10)
        exact.registerCallback(self.on_imus)

    def on_pair(self, left, right):
        self.pub.publish(Float64(data=left.height))  # sink left
        self.pub.publish(Float64(data=right.height))  # sink right
        self.pub.publish(Float64(data=left.height - right.height))  # sink left right
        self.pub.publish(Float64(data=1.0))  # clean

    def on_imus(self, *messages):
        first, second = messages
        self.pub.publish(Float64(data=first.angular_velocity.z))  # sink imu
        self.pub.publish(Float64(data=second.angular_velocity.z))  # sink imu


def main():
    rclpy.init()
    rclpy.spin(Stereo())
