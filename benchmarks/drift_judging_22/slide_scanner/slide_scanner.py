#!/usr/bin/env python
"""Slide scanner of a microscope: drives its stage from field to field and takes an image at each."""

import rospy
from std_msgs.msg import Bool, Empty, Int32, String

DEFAULTS = {
    "x": {"pitch": 2.0, "full_steps": 200, "micro": 16, "home": 1.5},  # mm per turn; mm from the switch
    "settle": 0.3,  # s after a move
    "fields": 7,
    "spacing": 2.2,  # mm between the middles of two fields
}


class SlideScanner:
    def __init__(self):
        cfg = rospy.get_param("~stage", DEFAULTS)
        axis = cfg["x"]
        self.steps_per_mm = axis["full_steps"] * axis["micro"] / axis["pitch"]
        self.home = axis["home"]
        self.settle = cfg["settle"]
        self.spacing = cfg["spacing"]
        self.fields = cfg["fields"]
        self.index = None
        self.still_since = None
        self.target_pub = rospy.Publisher("stage/target", Int32, queue_size=1)
        self.shot_pub = rospy.Publisher("camera/trigger", Empty, queue_size=1)
        self.state_pub = rospy.Publisher("scanner/state", String, queue_size=1)
        rospy.Subscriber("scanner/start", Bool, self.on_start)
        rospy.Subscriber("stage/moving", Bool, self.on_moving)
        rospy.Timer(rospy.Duration(0.1), self.on_timer)

    def on_start(self, msg):
        if msg.data and self.index is None:
            self.index = 0
            self.go()

    def on_moving(self, msg):
        if msg.data:
            self.still_since = None
        elif self.still_since is None:
            self.still_since = rospy.get_time()

    def to_steps(self, mm):
        return int(round(mm * self.steps_per_mm))

    def go(self):
        where = self.home + self.index * self.spacing
        self.still_since = None
        self.target_pub.publish(self.to_steps(where))

    def settled(self):
        return self.still_since is not None and rospy.get_time() - self.still_since > self.settle

    def on_timer(self, event):
        if self.index is None or not self.settled():
            return
        if self.index == self.fields:
            self.state_pub.publish("finished")
            return
        self.shot_pub.publish()
        self.index += 1
        if self.index < self.fields:
            self.go()


if __name__ == "__main__":
    rospy.init_node("slide_scanner")
    SlideScanner()
    rospy.spin()
