#!/usr/bin/env python
"""Inserts the weft of an air-jet loom: for each pick, a pressure and a time of blowing, trimmed by the yarn's arrival.

The yarn must arrive before the shed closes. It must not arrive too fast either, or the stop pin breaks it.
"""

import rospy
from geometry_msgs.msg import Vector3
from std_msgs.msg import Float32, Int32, String

PRESSURE_MIN, PRESSURE_MAX = 1.5, 10.0  # bar
BLOW_MIN, BLOW_MAX = 6.0, 40.0  # ms
TRIM = 0.08  # part of the time of blowing that the trim may add or take


def clamp(value, low, high):
    return max(low, min(high, value))


class WeftInserter(object):
    def __init__(self):
        self.pressure = rospy.get_param("~pressure", 4.0)  # bar
        self.blow = rospy.get_param("~blow", 21.5)  # ms
        self.arrival_wanted = rospy.get_param("~arrival", 39.5)  # ms after the release
        self.trim_gain = rospy.get_param("~trim_gain", 0.004)  # per ms
        self.max_stops = rospy.get_param("~max_stops", 3)
        self.trim = 0.0
        self.picks = 0
        self.mispicks = 0  # one after the other
        self.tex = None
        self.arrivals = []
        self.running = True
        self.jet_pub = rospy.Publisher("jet/insertion", Vector3, queue_size=1)
        self.stop_pub = rospy.Publisher("loom/stop", String, queue_size=1)
        self.trim_pub = rospy.Publisher("jet/trim", Float32, queue_size=1)
        rospy.Subscriber("loom/pick", Int32, self.on_pick)
        rospy.Subscriber("weft/arrival", Float32, self.on_arrival)
        rospy.Subscriber("creel/yarn", Float32, self.on_yarn)
        self.log_timer = rospy.Timer(rospy.Duration(2.0), self.log)

    def on_yarn(self, msg):
        if self.tex is None or abs(self.tex - msg.data) > 2.0:
            rospy.loginfo("yarn of %.0f tex", msg.data)
            self.trim = 0.0
        self.tex = msg.data

    def on_pick(self, msg):
        if not self.running:
            return
        self.picks = msg.data
        blow = self.blow * (1.0 + self.trim)
        insertion = Vector3()
        insertion.x = clamp(self.pressure, PRESSURE_MIN, PRESSURE_MAX)
        insertion.y = clamp(blow, BLOW_MIN, BLOW_MAX)
        self.jet_pub.publish(insertion)

    def on_arrival(self, msg):
        """Adapt to the arrival of the yarn in ms; a negative one stands for a yarn that did not arrive."""
        if msg.data < 0.0:
            self.mispicks += 1
            self.trim = clamp(self.trim + 0.02, -TRIM, TRIM)
            if self.mispicks >= self.max_stops:
                self.stop("weft does not arrive")
            return
        self.mispicks = 0
        self.arrivals = [*self.arrivals[-19:], msg.data]
        late = msg.data - self.arrival_wanted
        self.trim = clamp(self.trim + self.trim_gain * late, -TRIM, TRIM)

    def stop(self, reason):
        self.running = False
        rospy.logerr("stop after pick %d: %s", self.picks, reason)
        self.stop_pub.publish(reason)

    def log(self, event):
        self.trim_pub.publish(self.trim)
        if self.arrivals:
            mean = sum(self.arrivals) / len(self.arrivals)
            rospy.logdebug("arrival after %.1f ms, trim %+.3f, yarn of %s tex", mean, self.trim, self.tex)


if __name__ == "__main__":
    rospy.init_node("weft_inserter")
    WeftInserter()
    rospy.spin()
