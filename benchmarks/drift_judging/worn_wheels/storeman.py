#!/usr/bin/env python3
"""Drive along an aisle to the requested shelf by wheel ticks only, and report the arrival."""

import rospy
from geometry_msgs.msg import Twist
from odometry import travelled, turned
from std_msgs.msg import Bool, Float64, Int32MultiArray

CRUISE = 0.5  # m/s
SLOWEST = 0.04
CLOSE = 0.01  # m


class Storeman:
    """Compute the position from ticks and the command from the position."""

    def __init__(self):
        self.goal = None
        self.start = None
        self.place = 0.0
        self.heading = 0.0
        self.easing = rospy.get_param("~easing", 0.9)
        self.straighten = rospy.get_param("~straighten", 1.5)
        rospy.Subscriber("/shelf", Float64, self.on_shelf)
        rospy.Subscriber("/ticks", Int32MultiArray, self.on_ticks)
        self.drive = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.there = rospy.Publisher("/there", Bool, queue_size=1)
        rospy.Timer(rospy.Duration(0.1), self.on_timer)

    def on_shelf(self, msg):
        """Store the distance to the shelf, m."""
        self.goal = msg.data

    def on_ticks(self, msg):
        """Store the counts of the encoders since they were switched on."""
        left, right = msg.data
        if self.start is None:
            self.start = (left, right)
        left, right = left - self.start[0], right - self.start[1]
        self.place = travelled(left, right)
        self.heading = turned(left, right)

    def on_timer(self, _):
        """Send one command."""
        if self.goal is None or self.start is None:
            return
        cmd = Twist()
        left = self.goal - self.place
        if left < CLOSE:
            self.drive.publish(cmd)
            self.there.publish(True)
            return
        cmd.linear.x = max(SLOWEST, min(CRUISE, self.easing * left))
        cmd.angular.z = -self.straighten * self.heading
        self.drive.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("storeman")
    Storeman()
    rospy.spin()
