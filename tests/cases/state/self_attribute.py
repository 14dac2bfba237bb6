import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Range


class Stopper(Node):
    def __init__(self):
        super().__init__("stopper")
        self.distance = 1.0
        self.ceiling = 1.0
        self.gain = 0.5
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Range, "front", self.on_front, 10)  # source front
        self.create_subscription(Range, "top", self.on_top, 10)  # source top
        self.create_timer(0.1, self.step)

    def on_front(self, msg: Range) -> None:
        self.distance = msg.range

    def on_top(self, msg: Range) -> None:
        self.ceiling = msg.range

    def step(self) -> None:
        cmd = Twist()
        cmd.linear.x = self.gain * self.distance
        self.pub.publish(cmd)  # sink front
        cmd = Twist()
        cmd.linear.z = min(self.ceiling, self.distance)
        self.pub.publish(cmd)  # sink top front
        slow = Twist()
        slow.linear.x = self.gain
        self.pub.publish(slow)  # clean


def main():
    rclpy.init()
    node = Stopper()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
