#!/usr/bin/env python3
"""Follow a dark line with two reflectance sensors, one at either side of it."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float32MultiArray

PERIOD = 0.05  # of the control loop: s
KP = 5.0  # turn per difference in brightness: rad/s
KD = 2.0  # turn per change of it in one period: rad/s
MAX_TURN = 4.0  # rad/s
CAUTION = 0.3  # share of the speed that a full difference takes


class LineFollower(Node):
    """Steer towards the darker side."""

    def __init__(self):
        super().__init__("line_follower")
        self.declare_parameter("speed", 0.5)
        self.speed = self.get_parameter("speed").value
        self.error = 0.0
        self.previous = 0.0
        self.create_subscription(Float32MultiArray, "/reflectance", self.on_reflectance, 10)
        self.command = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(PERIOD, self.on_timer)

    def on_reflectance(self, msg):
        """Take the two brightness readings: the line is where it is darker."""
        left, right = msg.data
        self.error = right - left

    def on_timer(self):
        """Send one command."""
        change = self.error - self.previous
        self.previous = self.error
        turn = KP * self.error + KD * change
        cmd = Twist()
        cmd.linear.x = self.speed * (1.0 - CAUTION * abs(self.error))
        cmd.angular.z = max(-MAX_TURN, min(MAX_TURN, turn))
        self.command.publish(cmd)


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = LineFollower()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
