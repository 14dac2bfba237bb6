"""Drive along the rail to the target."""

import rclpy
from geometry_msgs.msg import PointStamped, Twist
from nav_msgs.msg import Odometry

from pallet_shuttle.stoppable import StoppableNode

GAIN = 0.8


class DriveNode(StoppableNode):
    """Proportional control of the position on the rail."""

    def __init__(self):
        super().__init__("drive_node", 0.1)
        self.declare_parameter("max_speed", 1.0)
        self._max_speed = self.get_parameter("max_speed").value
        self._position = 0.0
        self._target = None
        self._cmd_pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Odometry, "odom", self._on_odom, 10)
        self.create_subscription(PointStamped, "target", self._on_target, 10)

    def _on_odom(self, msg):
        self._position = msg.pose.pose.position.x

    def _on_target(self, msg):
        self._target = msg.point

    def halt(self):
        """Brake."""
        self._cmd_pub.publish(Twist())

    def step(self):
        """Move towards the target, or stand still as long as there is none."""
        cmd = Twist()
        if self._target is not None:
            speed = GAIN * (self._target.x - self._position)
            cmd.linear.x = max(-self._max_speed, min(self._max_speed, speed))
        self._cmd_pub.publish(cmd)

    def activity(self):
        """Return whether the node has a target."""
        return "waiting" if self._target is None else "driving"


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(DriveNode())
    rclpy.shutdown()
