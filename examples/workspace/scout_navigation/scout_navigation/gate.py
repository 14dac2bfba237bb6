"""Pass commands on to the wheels, limited, and nothing after the emergency stop."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool


class Gate(Node):
    """Stands between whoever drives and the wheels."""

    def __init__(self):
        super().__init__("gate")
        self.fastest = self.declare_parameter("fastest", 0.5).value
        self.stopped = False
        self.wheels = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "cmd_vel_raw", self.on_command, 10)
        self.create_subscription(Bool, "stop", self.on_stop, 10)

    def on_stop(self, stop):
        """Remember the emergency stop."""
        self.stopped = stop.data

    def on_command(self, command):
        """Limit a command and pass it on."""
        if self.stopped:
            self.wheels.publish(Twist())
            return
        limited = Twist()
        limited.linear.x = max(-self.fastest, min(self.fastest, command.linear.x))
        limited.angular.z = max(-1.0, min(1.0, command.angular.z))
        self.wheels.publish(limited)


def main():
    """Start the node."""
    rclpy.init()
    rclpy.spin(Gate())
