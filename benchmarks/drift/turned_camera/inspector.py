#!/usr/bin/env python3
"""Keep an inspection robot beside a weld seam that its camera sees."""

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32MultiArray

CAMERA = {"middle": 160.0, "metres": 0.001, "side": 1.0}


class Inspector:
    """Compute the offset from the seam and the steering from the offset."""

    def __init__(self, pull=2.5, damping=0.6):
        self.pull = pull
        self.damping = damping
        self.offset = None
        self.change = 0.0
        self.width = 0.0
        rospy.Subscriber("/seam", Float32MultiArray, self.on_seam)
        self.drive = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Timer(rospy.Duration(0.1), self.on_timer)

    def on_seam(self, msg):
        """Store the two edges of the seam, px."""
        left, right = msg.data
        seam = 0.5 * (left + right)
        offset = CAMERA["side"] * CAMERA["metres"] * (seam - CAMERA["middle"])
        if self.offset is not None:
            self.change = (offset - self.offset) / 0.1
        self.offset = offset
        self.width = CAMERA["metres"] * (right - left)

    def on_timer(self, _):
        """Send one command."""
        if self.offset is None:
            return
        cmd = Twist()
        cmd.linear.x = 0.2
        if self.width > 0.05:
            cmd.linear.x = 0.1
        turn = self.pull * self.offset + self.damping * self.change
        cmd.angular.z = max(-0.8, min(0.8, turn))
        self.drive.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("inspector")
    Inspector()
    rospy.spin()
