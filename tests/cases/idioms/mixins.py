"""Multiple inheritance: mixins that subscribe in a cooperative `__init__`, and hooks that the class overrides."""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, String


class OdometryMixin:
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.speed = 0.0
        self.create_subscription(Odometry, "odom", self._odom, 10)  # source odom

    def _odom(self, msg):
        self.speed = msg.twist.twist.linear.x
        self.on_speed(self.speed)

    def on_speed(self, speed):
        """Hook."""


class ScanMixin:
    scan_topic = "scan"

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.nearest = float("inf")
        self.create_subscription(LaserScan, self.scan_topic, self._scan, 10)  # source scan

    def _scan(self, msg):
        self.nearest = min(msg.ranges, default=float("inf"))


class HeartbeatMixin:
    def start_heartbeat(self, period=1.0):
        self._beat = self.create_publisher(Bool, "~/alive", 1)
        self._timer = self.create_timer(period, self._on_beat)

    def _on_beat(self):
        self._beat.publish(Bool(data=self.healthy()))  # sink ~scan

    def healthy(self):
        return True


class Cruise(OdometryMixin, ScanMixin, HeartbeatMixin, Node):
    def __init__(self):
        super().__init__("cruise", allow_undeclared_parameters=True)
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.text = self.create_publisher(String, "text", 10)
        self.start_heartbeat(0.5)

    def on_speed(self, speed):
        twist = Twist()
        twist.linear.x = speed + 0.1 * (1.0 - speed)
        if self.nearest < 0.5:
            twist.linear.x = 0.0
        self.cmd.publish(twist)  # sink odom ~scan
        self.text.publish(String(data=type(self).__name__))  # clean

    def healthy(self):
        if self.nearest > 0.1:
            return True
        return False


def main():
    rclpy.init()
    rclpy.spin(Cruise())


if __name__ == "__main__":
    main()
