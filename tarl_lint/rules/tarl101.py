"""TARL101: data of a subscribed topic reaches a published one.

A value computed from a received message is part of what the publish call sends (an *explicit* flow). Most robot
programs exist to do this. The finding shows which input affects which output, and the taint list shows the statements
on the way. Accept the intended flows with `--write-baseline`; later runs report only new flows.
"""

from __future__ import annotations

from typing import Final

from tarl_lint.model import Finding, Flow
from tarl_lint.rules.wording import end

CODE: Final = "TARL101"
SUMMARY: Final = "data of a subscribed topic reaches a published one"

INVALID: Final = (
    """
    import rospy
    from sensor_msgs.msg import Range
    from std_msgs.msg import Float64

    brake = rospy.Publisher("/brake", Float64, queue_size=1)

    def on_range(msg):
        force = 2.0 / msg.range
        brake.publish(force)

    rospy.Subscriber("/range", Range, on_range)
    """,
    """
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from rclpy.node import Node

    class Keeper(Node):
        def __init__(self):
            super().__init__("keeper")
            self.y = 0.0
            self.pub = self.create_publisher(Twist, "cmd_vel", 10)
            self.create_subscription(Odometry, "odom", self.on_odom, 10)
            self.create_timer(0.1, self.steer)

        def on_odom(self, msg):
            self.y = msg.pose.pose.position.y

        def steer(self):
            cmd = Twist()
            cmd.angular.z = -0.8 * self.y
            self.pub.publish(cmd)
    """,
)

VALID: Final = (
    """
    import rospy
    from sensor_msgs.msg import Range
    from std_msgs.msg import Float64

    brake = rospy.Publisher("/brake", Float64, queue_size=1)

    def on_range(msg):
        force = 2.0 / msg.range
        force = 0.5
        brake.publish(force)

    rospy.Subscriber("/range", Range, on_range)
    """,
)


def finding(flow: Flow) -> Finding:
    """Return the note for a flow, at its publish call."""
    return Finding(CODE, flow.sink.span, f"{end(flow.source)} reaches {end(flow.sink)}", flow)
