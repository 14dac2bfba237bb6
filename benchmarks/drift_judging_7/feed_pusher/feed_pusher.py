#!/usr/bin/env python
"""Push feed back to the fence of a cow barn at a set distance from the fence."""

import math

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Range


class FeedPusher(object):
    SONAR_SIDE = 0.22  # distance from the middle of the skirt to the sonar (m)

    def __init__(self):
        self.k_dist = rospy.get_param("~k_dist", 1.1)
        self.k_turn = rospy.get_param("~k_turn", 2.2)
        self.goal = rospy.get_param("~distance", 0.80)
        self.speed = rospy.get_param("~speed", 0.35)
        self.last = None
        self.slope = 0.0
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("sonar_left", Range, self.range_cb)

    def range_cb(self, msg):
        dist = msg.range + self.SONAR_SIDE
        if self.last is not None:
            raw = (dist - self.last) / (0.2 * self.speed)
            self.slope += 0.4 * (max(-1.0, min(1.0, raw)) - self.slope)
        self.last = dist
        self.drive(dist)

    def drive(self, dist):
        error = dist - self.goal
        heading = math.atan(self.slope)
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = max(-0.5, min(0.5, self.k_dist * error + self.k_turn * heading))
        self.cmd.publish(twist)


if __name__ == "__main__":
    rospy.init_node("feed_pusher")
    FeedPusher()
    rospy.spin()
