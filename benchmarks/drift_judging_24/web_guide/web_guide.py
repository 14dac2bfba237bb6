#!/usr/bin/env python
"""Web guide of a printing press: swivels a pair of rollers so that the edge of the paper stays at its place.

An ultrasonic sensor sees the edge behind the rollers. A splice passes it as a jump, which is not an error of the edge.
"""

import rospy
from std_msgs.msg import Bool, Float32, String

GAIN = 1.3  # mrad/s of swivel per mm
DEAD_BAND = 0.2  # mm
MAX_RATE = 12.0  # mrad/s
MAX_SWIVEL = 60.0  # mrad
JUMP = 12.0  # mm between two readings
HOLD = 0.4  # s after a splice
PERIOD = 0.1


def limit(value, most):
    return max(-most, min(most, value))


class WebGuide(object):
    def __init__(self):
        self.offset = rospy.get_param("~edge_offset", 0.0)  # mm, the edge of this job
        self.lost_after = rospy.get_param("~lost_after", 2.0)  # s
        self.smoothing = rospy.get_param("~smoothing", 0.7)
        self.mode = "centre"
        self.edge = None
        self.last_raw = None
        self.seen = None
        self.splice_until = 0.0
        self.swivel = 0.0
        self.tension = None
        self.rate_pub = rospy.Publisher("guide/rate", Float32, queue_size=1)
        self.mode_pub = rospy.Publisher("guide/mode", String, queue_size=1)
        rospy.Subscriber("web/edge", Float32, self.on_edge)
        rospy.Subscriber("web/tension", Float32, self.on_tension)
        rospy.Subscriber("guide/swivel", Float32, self.on_swivel)
        rospy.Subscriber("press/running", Bool, self.on_running)
        rospy.Timer(rospy.Duration(PERIOD), self.control)
        rospy.Timer(rospy.Duration(5.0), self.log)

    def on_edge(self, msg):
        now = rospy.get_time()
        if self.last_raw is not None and abs(msg.data - self.last_raw) > JUMP:
            self.splice_until = now + HOLD
        self.last_raw = msg.data
        if self.edge is None:
            self.edge = msg.data
        self.edge += self.smoothing * (msg.data - self.edge)
        self.seen = now

    def on_tension(self, msg):
        self.tension = msg.data

    def on_swivel(self, msg):
        self.swivel = msg.data

    def on_running(self, msg):
        self.mode = "automatic" if msg.data else "centre"

    def rate(self):
        """Return how fast the rollers must swivel, in mrad/s."""
        now = rospy.get_time()
        if self.seen is None or now - self.seen > self.lost_after:
            return limit(-0.5 * self.swivel, MAX_RATE)
        if now < self.splice_until:
            return 0.0
        error = self.edge - self.offset
        if abs(error) < DEAD_BAND:
            return 0.0
        return limit(-GAIN * error, MAX_RATE)

    def control(self, event):
        if self.mode == "automatic":
            rate = self.rate()
            if abs(self.swivel) > MAX_SWIVEL and rate * self.swivel > 0.0:
                rate = 0.0
        else:
            rate = limit(-0.5 * self.swivel, MAX_RATE)
        self.rate_pub.publish(rate)
        self.mode_pub.publish(self.mode)

    def log(self, event):
        if self.edge is not None:
            rospy.loginfo(
                "edge %+.1f mm, swivel %+.0f mrad, tension %s N", self.edge, self.swivel, self.tension
            )


if __name__ == "__main__":
    rospy.init_node("web_guide")
    WebGuide()
    rospy.spin()
