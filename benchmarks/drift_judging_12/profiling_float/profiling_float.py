#!/usr/bin/env python
"""Profiling float: sink, park at a depth, rise again; oil that is pumped into a bladder carries it."""

import rospy
from std_msgs.msg import Float32

NEUTRAL = 300.0  # volume of oil with which the float hovers (cm3)
SINK, RISE = 120.0, 160.0  # decrease, increase of the volume (cm3)
PARK = 45.0  # m
NEAR = 12.0  # height above the parking depth at which the float starts to brake (m)
PARKED = 600.0  # s
KP = 12.0  # cm3 per m
KD = 900.0  # volume per speed (cm3 per m/s)
MAX_OIL = 1000.0
PERIOD = 5.0


class Profile(object):
    """The measurements of the way up, which are sent at the surface."""

    def __init__(self):
        self.rows = []

    def add(self, depth, salinity):
        if not self.rows or self.rows[-1][0] - depth > 2.0:
            self.rows.append((depth, salinity))

    def mean(self):
        return sum(row[1] for row in self.rows) / max(1, len(self.rows))


class ProfilingFloat(object):
    def __init__(self):
        self.depth = None
        self.speed = 0.0
        self.salinity = None
        self.state = "sink"
        self.since = None
        self.profile = Profile()
        self.oil = rospy.Publisher("bladder/oil", Float32, queue_size=1)
        rospy.Subscriber("ctd/depth", Float32, self.on_depth)
        rospy.Subscriber("ctd/salinity", Float32, self.on_salinity)

    def on_depth(self, msg):
        if self.depth is not None:
            self.speed += 0.4 * ((msg.data - self.depth) / PERIOD - self.speed)
        self.depth = msg.data

    def on_salinity(self, msg):
        self.salinity = msg.data

    def enter(self, state):
        rospy.loginfo("%s at %.1f m", state, self.depth)
        self.state = state
        self.since = rospy.get_time()

    def volume(self, extra):
        """Return the oil for an extra lift, within what the bladder holds."""
        return min(MAX_OIL, max(0.0, NEUTRAL + extra))

    def step(self):
        if self.state == "sink":
            if self.depth > PARK - NEAR:
                self.enter("park")
            return self.volume(-SINK)
        if self.state == "park":
            if rospy.get_time() - self.since > PARKED:
                self.enter("rise")
            return self.volume(KP * (self.depth - PARK) + KD * self.speed)
        self.profile.add(self.depth, self.salinity)
        if self.depth < 1.5:
            rospy.loginfo_once("at the surface, mean salinity %.1f", self.profile.mean())
        return self.volume(RISE)

    def run(self):
        rate = rospy.Rate(1.0 / PERIOD)
        while not rospy.is_shutdown():
            if self.depth is not None:
                self.oil.publish(Float32(data=self.step()))
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("profiling_float")
    ProfilingFloat().run()
