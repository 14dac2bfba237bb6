#!/usr/bin/env python
"""Fan of a pipe organ: holds the pressure of the wind, in mm of water, whatever the organist draws.

The console tells how many stops are drawn, so that the fan speeds up before the pressure drops.
"""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

OFF, RUN_UP, PLAY = "off", "run up", "play"


class Fan(object):
    """Speeds of the fan in rpm."""

    IDLE = 700.0
    LOWEST = 600.0
    HIGHEST = 1500.0

    def __init__(self, base, per_stop, gain):
        self.base = base
        self.per_stop = per_stop
        self.gain = gain

    def speed(self, error, stops):
        wanted = self.base + self.per_stop * stops + self.gain * error
        return max(self.LOWEST, min(self.HIGHEST, wanted))


class OrganBlower(object):
    def __init__(self):
        self.pressure_wanted = rospy.get_param("~pressure", 80.0)  # mm of water
        self.alpha = rospy.get_param("~smoothing", 0.6)
        self.ramp = rospy.get_param("~ramp", 400.0)  # rpm/s, so that the reservoir does not bounce
        self.fan = Fan(
            base=rospy.get_param("~base_rpm", 1000.0),
            per_stop=rospy.get_param("~rpm_per_stop", 12.0),
            gain=rospy.get_param("~gain", 4.0),
        )
        self.state = OFF
        self.key = False
        self.stops = 0
        self.pressure = 0.0
        self.rpm = 0.0
        self.period = 0.1
        self.rpm_pub = rospy.Publisher("fan/rpm", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("fan/state", String, queue_size=1)
        rospy.Subscriber("chest/pressure", Float32, self.pressure_cb)
        rospy.Subscriber("console/stops", Int32, self.stops_cb)
        rospy.Subscriber("console/key", Bool, self.key_cb)
        rospy.Timer(rospy.Duration(self.period), self.control)
        rospy.Timer(rospy.Duration(10.0), self.log)

    def pressure_cb(self, msg):
        self.pressure += self.alpha * (msg.data - self.pressure)

    def stops_cb(self, msg):
        self.stops = max(0, msg.data)

    def key_cb(self, msg):
        self.key = msg.data

    def next_state(self):
        if not self.key:
            return OFF
        if self.state == OFF:
            return RUN_UP
        if self.state == RUN_UP and self.pressure > 0.5 * self.pressure_wanted:
            rospy.loginfo("wind is up")
            return PLAY
        return self.state

    def wanted(self):
        if self.state == OFF:
            return 0.0
        if self.state == RUN_UP:
            return self.fan.base
        error = self.pressure_wanted - self.pressure
        return self.fan.speed(error, self.stops)

    def control(self, event):
        self.state = self.next_state()
        step = self.ramp * self.period
        self.rpm += max(-step, min(step, self.wanted() - self.rpm))
        self.rpm_pub.publish(self.rpm)
        self.state_pub.publish(self.state)

    def log(self, event):
        rospy.logdebug("%s: %.0f rpm, %.1f mm, %d stops", self.state, self.rpm, self.pressure, self.stops)


if __name__ == "__main__":
    rospy.init_node("organ_blower")
    OrganBlower()
    rospy.spin()
