#!/usr/bin/env python
"""Land a multirotor on a marker: centre above the marker, and sink while inside the funnel above it."""

import math

import rospy
from geometry_msgs.msg import PoseStamped, TwistStamped, Vector3
from std_msgs.msg import String

G = 9.81


def saturate(value, limit):
    if value > limit:
        return limit
    if value < -limit:
        return -limit
    return value


class MarkerLander:
    def __init__(self):
        self.kp = rospy.get_param("~kp", 2.2)
        self.kd = rospy.get_param("~kd", 2.4)
        self.max_tilt = math.radians(rospy.get_param("~max_tilt_deg", 9.0))
        self.funnel = rospy.get_param("~funnel", 0.35)
        self.sink = rospy.get_param("~sink_rate", 0.6)
        self.state = "approach"
        self.vx = self.vy = 0.0
        self.command = rospy.Publisher("command", Vector3, queue_size=1)
        self.report = rospy.Publisher("lander/state", String, queue_size=1, latch=True)
        rospy.Subscriber("velocity", TwistStamped, self.velocity_cb)
        rospy.Subscriber("marker", PoseStamped, self.marker_cb)

    def velocity_cb(self, msg):
        self.vx = msg.twist.linear.x
        self.vy = msg.twist.linear.y

    def change(self, state):
        if state != self.state:
            rospy.loginfo("%s -> %s", self.state, state)
            self.state = state
            self.report.publish(String(state))

    def tilt(self, offset, speed):
        """Return the tilt in rad that accelerates towards the marker."""
        accel = self.kp * offset - self.kd * speed
        return saturate(math.atan2(accel, G), self.max_tilt)

    def marker_cb(self, msg):
        dx, dy = msg.pose.position.x, msg.pose.position.y
        height = -msg.pose.position.z
        off = math.hypot(dx, dy)
        sink = 0.0
        if height < 0.12:
            self.change("landed")
            self.command.publish(Vector3(0.0, 0.0, self.sink))
            return
        if off < self.funnel + 0.1 * height:
            self.change("descend")
            sink = self.sink if height > 1.0 else 0.5 * self.sink
        else:
            self.change("approach")
        self.command.publish(Vector3(self.tilt(dx, self.vx), self.tilt(dy, self.vy), sink))


if __name__ == "__main__":
    rospy.init_node("marker_lander")
    lander = MarkerLander()
    rospy.spin()
