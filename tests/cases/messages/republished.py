import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import Image
from std_msgs.msg import String


class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.latest = None
        self.plain = self.create_publisher(Twist, "plain", 10)
        self.stamped = self.create_publisher(TwistStamped, "stamped", 10)
        self.image = self.create_publisher(Image, "image_out", 10)
        self.text = self.create_publisher(String, "text", 10)
        self.create_subscription(Twist, "cmd", self.on_cmd, 10)  # source cmd
        self.create_subscription(Image, "image", self.on_image, 10)  # source image
        self.create_timer(0.1, self.again)

    def on_cmd(self, msg):
        self.plain.publish(msg)  # sink cmd
        stamped = TwistStamped()
        stamped.header.stamp = self.get_clock().now().to_msg()
        stamped.twist = msg
        self.stamped.publish(stamped)  # sink cmd
        msg.linear.x = 0.0
        self.plain.publish(msg)  # sink cmd
        msg.linear.x = min(msg.angular.z, 1.0)
        self.latest = msg

    def on_image(self, msg):
        out = Image()
        out.header = msg.header
        self.image.publish(out)  # sink image
        fresh = Image()
        fresh.header.stamp = self.get_clock().now().to_msg()
        fresh.header.frame_id = "camera"
        self.image.publish(fresh)  # clean

    def again(self):
        if self.latest is None:
            return
        self.plain.publish(self.latest)  # sink cmd
        self.text.publish(String(data="alive"))  # clean


def main():
    rclpy.init()
    rclpy.spin(Relay())
