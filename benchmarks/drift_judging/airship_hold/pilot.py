#!/usr/bin/env python3
"""Fly an airship to a mast and moor it."""

import math

import rospy
from geometry_msgs.msg import PoseStamped, Twist
from std_msgs.msg import Float64

APPROACH = {"gain": 0.25, "most": 1.6, "near": 2.0, "slow": 0.5}  # 1/s, m/s, m, m/s
MOST_TURN = 0.5  # rad/s


class Pilot:
    """Fly towards the mast, more slowly near it."""

    def __init__(self):
        self.place = None
        self.heading = 0.0
        self.mast = rospy.get_param("~mast", [20.0, 0.0])
        rospy.Subscriber("/pose", PoseStamped, self.on_pose)
        rospy.Subscriber("/compass", Float64, self.on_compass)
        self.propeller = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Timer(rospy.Duration(0.5), self.on_timer)

    def on_pose(self, msg):
        """Store the position of the airship."""
        self.place = msg.pose.position

    def on_compass(self, msg):
        """Store the heading of the airship, left positive, rad."""
        self.heading = msg.data

    def on_timer(self, _):
        """Send one command."""
        if self.place is None:
            return
        dx, dy = self.mast[0] - self.place.x, self.mast[1] - self.place.y
        away = math.hypot(dx, dy)
        bearing = math.atan2(dy, dx) - self.heading
        bearing = math.atan2(math.sin(bearing), math.cos(bearing))
        cmd = Twist()
        cmd.linear.x = min(APPROACH["most"], APPROACH["slow"] + APPROACH["gain"] * away)
        if away < APPROACH["near"]:
            cmd.linear.x = APPROACH["slow"]
        cmd.angular.z = max(-MOST_TURN, min(MOST_TURN, 0.8 * bearing))
        self.propeller.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("pilot")
    Pilot()
    rospy.spin()
