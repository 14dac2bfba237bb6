#!/usr/bin/env python3
"""Waypoint follower for the orchard rover (GPS + compass)."""

import rospy
from geo import bearing, distance, heading_from_compass, wrap
from geometry_msgs.msg import PointStamped, Twist
from std_msgs.msg import Float32

# tuned 2019-05, dry ground
KP_TURN = 1.4
MAX_TURN = 0.9
V_MAX = 0.8
V_TURNING = 0.3
TURN_IN_PLACE = 0.9  # rad
REACHED = 0.5
ALPHA_GPS = 0.6


class WaypointFollower:
    """Drive to each waypoint in turn."""

    def __init__(self):
        self.waypoints = rospy.get_param("~waypoints", [[5.0, 0.0], [11.0, 0.0]])
        self.index = 0
        self.here = None
        self.heading = None
        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("gps", PointStamped, self.gps_cb, queue_size=1)
        rospy.Subscriber("compass", Float32, self.compass_cb, queue_size=1)

    def gps_cb(self, msg):
        """Low-pass the position."""
        x, y = msg.point.x, msg.point.y
        if self.here is not None:
            x = ALPHA_GPS * x + (1.0 - ALPHA_GPS) * self.here[0]
            y = ALPHA_GPS * y + (1.0 - ALPHA_GPS) * self.here[1]
        self.here = (x, y)

    def compass_cb(self, msg):
        """Convert the compass reading to a heading."""
        self.heading = heading_from_compass(msg.data)

    def compute(self):
        """Return the command for this cycle."""
        cmd = Twist()
        if self.index >= len(self.waypoints):
            return cmd
        goal = self.waypoints[self.index]
        if distance(self.here, goal) < REACHED:
            rospy.loginfo("waypoint %d reached", self.index)
            self.index += 1
            return self.compute()
        error = wrap(bearing(self.here, goal) - self.heading)
        cmd.angular.z = max(-MAX_TURN, min(MAX_TURN, KP_TURN * error))
        cmd.linear.x = V_TURNING if abs(error) > TURN_IN_PLACE else V_MAX
        return cmd

    def spin(self):
        """Publish commands at 10 Hz."""
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if self.here is not None and self.heading is not None:
                self.cmd_pub.publish(self.compute())
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("waypoint_follower")
    WaypointFollower().spin()
