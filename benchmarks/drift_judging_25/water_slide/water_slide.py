#!/usr/bin/env python
"""Lights of a water slide: shows green to one guest at a time, when the guest before is far enough ahead.

A light barrier behind the gate sees each guest who starts, another one sees who leaves the run-out.
"""

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Bool, Float32, Int32

SLIDE = {
    "name": "black hole",
    "interval": 9.0,  # s from start to start
    "green": 3.0,  # s that the light stays green if nobody starts
    "most_on_slide": 4,
    "pause": 1.0,  # s between two greens
    "lowest_flow": 0.2,  # of the pump's rating
    "longest_ride": 90.0,  # s until a guest counts as lost
}


class Slide(object):
    def __init__(self, settings):
        self.settings = dict(settings)
        self.settings.update(rospy.get_param("~slide", {}))
        self.riders = []  # times at which those on the slide started
        self.last_start = None
        self.green_since = None
        self.red_since = None
        self.flow = None
        self.blocked = ""
        self.total = 0
        self.light = rospy.Publisher("gate/green", Bool, queue_size=1)
        self.count = rospy.Publisher("slide/riders", Int32, queue_size=1)
        self.diagnostics = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1)
        rospy.Subscriber("gate/passed", Bool, self.started)
        rospy.Subscriber("runout/passed", Bool, self.left)
        rospy.Subscriber("pump/flow", Float32, self.flowing)
        rospy.Timer(rospy.Duration(0.5), self.update)
        rospy.Timer(rospy.Duration(5.0), self.diagnose)

    def flowing(self, msg):
        self.flow = msg.data

    def started(self, msg):
        if not msg.data:
            return
        now = rospy.get_time()
        if self.green_since is None:
            rospy.logwarn("a guest started at a red light")
        self.riders.append(now)
        self.total += 1
        self.last_start = now
        self.turn_red(now)

    def left(self, msg):
        if msg.data and self.riders:
            ride = rospy.get_time() - self.riders.pop(0)
            rospy.logdebug("ride of %.1f s", ride)

    def turn_red(self, now):
        self.green_since = None
        self.red_since = now

    def check(self, now):
        """Return why nobody may start, or an empty text."""
        if self.flow is None or self.flow < self.settings["lowest_flow"]:
            return "no water"
        if self.riders and now - self.riders[0] > self.settings["longest_ride"]:
            return "guest is stuck"
        return ""

    def may_start(self, now):
        if len(self.riders) >= self.settings["most_on_slide"]:
            return False
        if self.red_since is not None and now - self.red_since < self.settings["pause"]:
            return False
        return self.last_start is None or now - self.last_start >= self.settings["interval"]

    def update(self, event):
        now = rospy.get_time()
        blocked = self.check(now)
        if blocked and blocked != self.blocked:
            rospy.logerr("%s: %s", self.settings["name"], blocked)
        self.blocked = blocked
        if blocked:
            self.turn_red(now)
        elif self.green_since is not None:
            if now - self.green_since > self.settings["green"]:
                self.turn_red(now)
        elif self.may_start(now):
            self.green_since = now
        self.light.publish(self.green_since is not None)
        self.count.publish(len(self.riders))

    def diagnose(self, event):
        level = DiagnosticStatus.ERROR if self.blocked else DiagnosticStatus.OK
        values = [KeyValue("riders", str(self.total)), KeyValue("flow", str(self.flow))]
        status = DiagnosticStatus(
            level=level, name=self.settings["name"], message=self.blocked, values=values
        )
        self.diagnostics.publish(DiagnosticArray(status=[status]))


if __name__ == "__main__":
    rospy.init_node("water_slide")
    slide = Slide(SLIDE)
    rospy.spin()
