#!/usr/bin/env python
"""Bend sheets to their angle on a press brake: stroke, relax, measure, and correct the stroke.

The angle is measured after the punch has gone up, when the sheet has sprung back.
"""

import rospy
from std_msgs.msg import Bool, Float32, String

OVERBEND = 1.03  # ratio of the first stroke to the wanted angle, for mild steel
TRUST = 0.6  # share of the error corrected in one stroke; a larger share bends soft sheets too far
MAX_HITS = 3  # maximum number of strokes for a sheet
CLOSE = 0.4  # deg

PRESSING, RELAXING, UNLOADING = "pressing", "relaxing", "unloading"


class Bender(object):
    def __init__(self):
        self.target = None
        self.angle = 0.0
        self.down = False
        self.stroke = 0.0
        self.hits = 0
        self.phase = UNLOADING
        self.wait = 0
        self.punch = rospy.Publisher("press/stroke", Float32, queue_size=1)
        self.out = rospy.Publisher("press/unload", Bool, queue_size=1)
        self.info = rospy.Publisher("press/phase", String, queue_size=1)
        rospy.Subscriber("job/angle", Float32, self.job_cb)
        rospy.Subscriber("press/measured", Float32, self.measured_cb)
        rospy.Subscriber("press/down", Bool, self.down_cb)

    def job_cb(self, msg):
        """Start with the angle of a new sheet; 0 means no sheet."""
        if msg.data <= 0.0:
            self.target = None
        elif self.target is None:
            self.target = msg.data
            self.hits = 0
            self.hit(OVERBEND * self.target)

    def measured_cb(self, msg):
        self.angle = msg.data

    def down_cb(self, msg):
        self.down = msg.data

    def hit(self, stroke):
        """Begin a stroke to this angle."""
        self.stroke = stroke
        self.hits += 1
        self.phase = PRESSING

    def good(self, error):
        return abs(error) < CLOSE

    def judge(self):
        """Unload the relaxed sheet or bend it again."""
        error = self.target - self.angle
        if self.good(error):
            self.phase = UNLOADING
        elif error < 0.0:
            rospy.logwarn("bent too far by %.1f deg", -error)
            self.phase = UNLOADING
        elif self.hits >= MAX_HITS:
            rospy.logwarn("still %.1f deg after %d strokes", error, self.hits)
            self.phase = UNLOADING
        else:
            self.hit(self.stroke + TRUST * error)

    def spin_once(self):
        if self.phase == PRESSING and self.down:
            self.phase, self.wait = RELAXING, 3
        elif self.phase == RELAXING:
            self.wait -= 1
            if self.wait <= 0:
                self.judge()
        self.punch.publish(self.stroke if self.phase == PRESSING else 0.0)
        self.out.publish(self.target is not None and self.phase == UNLOADING)
        self.info.publish(self.phase)


def main():
    rospy.init_node("bender")
    bender = Bender()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        bender.spin_once()
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
