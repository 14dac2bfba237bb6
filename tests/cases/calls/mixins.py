import rclpy
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float64


class BatteryMixin:
    battery = 1.0

    def listen_to_battery(self, topic="battery"):
        self.create_subscription(BatteryState, topic, self.on_battery, 10)  # source battery

    def on_battery(self, msg):
        self.battery = msg.percentage


class SpeedMixin:
    base_speed = 0.5

    @property
    def speed(self):
        return self.base_speed * self.battery

    @property
    def top_speed(self):
        return 2.0 * self.base_speed


class Cart(BatteryMixin, SpeedMixin, Node):
    def __init__(self):
        super().__init__("cart")
        self.pub = self.create_publisher(Float64, "speed", 10)
        self.listen_to_battery()
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.pub.publish(Float64(data=self.speed))  # sink battery
        self.pub.publish(Float64(data=self.top_speed))  # clean


def main():
    rclpy.init()
    rclpy.spin(Cart())
