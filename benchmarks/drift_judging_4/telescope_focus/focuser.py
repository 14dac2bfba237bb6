#!/usr/bin/env python
"""Keep a telescope in focus through the night: filter offsets from a table, temperature from a sensor at the tube."""

import os

import numpy as np
import rospy
from std_msgs.msg import Bool, Float32, Int32, String


def read_table(path):
    """Read `name steps` lines into a dict."""
    table = {}
    for line in open(path):
        line = line.split("#")[0].split()
        if line:
            table[line[0]] = int(line[1])
    return table


class Focuser:
    COMPENSATION = 26.0  # focus change (steps/K); a colder tube is shorter
    BACKLASH = 60  # steps of overshoot, so that each position is approached from the same side
    DEADBAND = 6

    def __init__(self):
        here = os.path.dirname(os.path.abspath(__file__))
        self.offsets = read_table(os.path.join(here, rospy.get_param("~filters", "filters.txt")))
        self.temps = np.full(3, np.nan)
        self.best = None
        self.best_at = None
        self.filter = "L"
        self.position = None
        self.move = rospy.Publisher("focuser/move_to", Int32, queue_size=5)
        self.sharp = rospy.Publisher("focuser/settled", Bool, queue_size=5)
        rospy.Subscriber("autofocus/best", Int32, self.on_best)
        rospy.Subscriber("wheel/filter", String, self.on_filter)
        rospy.Subscriber("tube/temperature", Float32, self.on_temperature)

    @property
    def temperature(self):
        return float(np.nanmean(self.temps))

    def on_best(self, msg):
        """Store the result of the autofocus run at dusk, through the luminance filter."""
        if self.best is None and not np.isnan(self.temps).all():
            self.best = msg.data
            self.best_at = self.temperature

    def on_filter(self, msg):
        if msg.data not in self.offsets:
            rospy.logwarn("no focus offset for filter %s", msg.data)
            return
        self.filter = msg.data

    def on_temperature(self, msg):
        self.temps = np.append(self.temps[1:], msg.data)
        self.update()

    def wanted(self):
        """Return the focus position for this temperature and filter."""
        colder = self.best_at - self.temperature
        return self.best + self.COMPENSATION * colder + self.offsets[self.filter]

    def update(self):
        if self.best is None:
            return
        wanted = int(round(self.wanted()))
        if self.position is not None and abs(wanted - self.position) < self.DEADBAND:
            self.sharp.publish(True)
            return
        if self.position is None or wanted < self.position:
            self.move.publish(wanted - self.BACKLASH)
        self.move.publish(wanted)
        self.position = wanted
        self.sharp.publish(True)


if __name__ == "__main__":
    rospy.init_node("focuser")
    Focuser()
    rospy.spin()
