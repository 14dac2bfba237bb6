#!/usr/bin/env python3
"""Keep a boat on the middle line of a fairway that runs east."""

import rospy
from geometry_msgs.msg import PointStamped
from std_msgs.msg import Float64

CROSS_GAIN = 0.05  # course change per metre of distance from the line, rad/m
MOST_CROSSING = 0.7  # rad
HEADING_GAIN = 1.2
YAW_DAMPING = 0.6  # s
MOST_RUDDER = 0.5  # rad
CRUISE = 4.0  # m/s
EASE = 1.5  # reduction of speed at full rudder, m/s


class Helmsman:
    """Steer by position and compass."""

    def __init__(self):
        self.cross = None
        self.heading = 0.0
        self.before = 0.0
        rospy.Subscriber("/fix", PointStamped, self.on_fix)
        rospy.Subscriber("/compass", Float64, self.on_compass)
        self.rudder = rospy.Publisher("/rudder", Float64, queue_size=1)
        self.throttle = rospy.Publisher("/throttle", Float64, queue_size=1)
        rospy.Timer(rospy.Duration(0.25), self.steer)

    def on_fix(self, msg):
        """Store the distance from the middle line, north positive."""
        self.cross = msg.point.y

    def on_compass(self, msg):
        """Store the heading, north of east positive."""
        self.heading = msg.data

    def steer(self, _):
        """Send one command."""
        if self.cross is None:
            return
        course = -CROSS_GAIN * self.cross
        course = max(-MOST_CROSSING, min(MOST_CROSSING, course))
        turning = (self.heading - self.before) / 0.25
        self.before = self.heading
        rudder = HEADING_GAIN * (course - self.heading) - YAW_DAMPING * turning
        rudder = max(-MOST_RUDDER, min(MOST_RUDDER, rudder))
        self.rudder.publish(rudder)
        self.throttle.publish(CRUISE - EASE * abs(rudder) / MOST_RUDDER)


if __name__ == "__main__":
    rospy.init_node("boat")
    Helmsman()
    rospy.spin()
