#!/usr/bin/env python
"""Grade control of an excavator: hold the edge of the bucket on the plane of a laser while the stick pulls in."""

import rospy
from std_msgs.msg import Bool, Float32, String

SPOOL_DEADBAND = 0.10  # share of its travel that the spool covers before oil flows
GAIN = 3.5  # spool travel per m of height
SPOOL_LIMIT = 0.9
STICK_SPOOL = 0.45  # spool command that pulls the stick in
TOLERANCE = 0.008  # m
OIL_HOT = 85.0  # degrees C
ON_GRADE = 0.04  # maximum height error before the stick starts (m)


def sign(value):
    return 1.0 if value > 0.0 else -1.0


class TrenchDigger(object):
    def __init__(self):
        self.depth = rospy.get_param("~depth", 0.0)  # height above (+) or below (-) the laser plane (m)
        self.height = None
        self.reach = 0.0
        self.oil = 50.0
        self.enabled = True
        self.state = "LOWER"
        self.boom_pub = rospy.Publisher("valves/boom", Float32, queue_size=1)
        self.stick_pub = rospy.Publisher("valves/stick", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("digger/state", String, queue_size=1)
        rospy.Subscriber("laser/height", Float32, self.height_cb)
        rospy.Subscriber("stick/reach", Float32, self.reach_cb)
        rospy.Subscriber("hydraulics/oil_temp", Float32, self.oil_cb)
        rospy.Subscriber("cabin/enable", Bool, self.enable_cb)

    def height_cb(self, msg):
        self.height = msg.data

    def reach_cb(self, msg):
        self.reach = msg.data

    def oil_cb(self, msg):
        self.oil = msg.data
        if self.oil > OIL_HOT:
            rospy.logwarn_throttle(30, "oil is at %.0f degrees" % self.oil)

    def enable_cb(self, msg):
        self.enabled = msg.data

    def spool(self, error):
        """Position of the boom's spool; its deadband is jumped over."""
        if abs(error) < TOLERANCE:
            return 0.0
        value = GAIN * error + SPOOL_DEADBAND * sign(error)
        return max(-SPOOL_LIMIT, min(SPOOL_LIMIT, value))

    def update(self, event=None):
        if self.height is None:
            return
        error = self.depth - self.height
        boom = self.spool(error)
        stick = 0.0
        if self.state == "LOWER":
            if abs(error) < ON_GRADE:
                self.state = "PULL"
        elif self.state == "PULL":
            stick = STICK_SPOOL
            if self.reach < 3.0:
                self.state = "CURL"
                rospy.loginfo("pass done, oil at %.0f degrees", self.oil)
        elif self.state == "CURL":
            boom = 0.0
        if not self.enabled:
            boom, stick = 0.0, 0.0
        self.boom_pub.publish(boom)
        self.stick_pub.publish(stick)
        self.state_pub.publish(self.state)


def main():
    rospy.init_node("trench_digger")
    digger = TrenchDigger()
    rospy.Timer(rospy.Duration(0.1), digger.update)
    rospy.spin()


if __name__ == "__main__":
    main()
