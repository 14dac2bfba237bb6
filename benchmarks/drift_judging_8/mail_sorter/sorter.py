#!/usr/bin/env python
"""Find the fluorescent stamps on letters and send letters without one to the clerks."""

import rospy
from std_msgs.msg import Bool, Float64, Int32

DEFAULTS = {
    "stamp_level": 46.0,  # counts above the paper
    "paper_alpha": 0.08,
    "min_samples": 3,
    "gap_level": 4.0,
}


class Sorter(object):
    def __init__(self, params):
        self.params = params
        self.paper = None
        self.bright = 0
        self.samples = 0
        self.letters = 0
        self.divert_pub = rospy.Publisher("gate/divert", Bool, queue_size=1)
        self.count_pub = rospy.Publisher("sorter/letters", Int32, queue_size=1)

    def is_gap(self, value):
        return value < self.params["gap_level"]

    def is_stamp(self, value):
        return value - self.paper > self.params["stamp_level"]

    def start_letter(self):
        self.bright = 0
        self.samples = 0
        self.paper = None

    def finish_letter(self):
        self.letters += 1
        stamped = self.bright >= self.params["min_samples"]
        self.divert_pub.publish(Bool(not stamped))
        self.count_pub.publish(Int32(self.letters))
        self.start_letter()

    def light_callback(self, msg):
        value = msg.data
        if self.is_gap(value):
            if self.samples:
                self.finish_letter()
            return
        self.samples += 1
        if self.paper is None:
            self.paper = value
        if self.is_stamp(value):
            self.bright += 1
        else:
            self.paper += self.params["paper_alpha"] * (value - self.paper)


def main():
    rospy.init_node("mail_sorter")
    params = {name: rospy.get_param("~" + name, value) for name, value in DEFAULTS.items()}
    sorter = Sorter(params)
    rospy.Subscriber("reader/light", Float64, sorter.light_callback)
    rospy.spin()


if __name__ == "__main__":
    main()
