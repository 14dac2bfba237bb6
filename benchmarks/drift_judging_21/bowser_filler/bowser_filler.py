#!/usr/bin/env python
"""Fills a water bowser under its hydrant: an ultrasonic sensor in the lid watches the level, and the valve shuts."""

import rospy
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32, String


class BowserFiller(object):
    SENSOR_HEIGHT = 1.62  # m from the bottom of the tank to the face of the sensor
    FULL = 1.3  # m of water
    TRICKLE = 0.1  # m below full, where the valve closes to a trickle
    BLIND = 0.2  # m, shorter echoes are the ringing of the sensor
    LITRES = [(0.0, 0.0), (0.3, 410.0), (0.7, 1180.0), (1.1, 1960.0), (1.4, 2380.0)]  # of a round tank

    def __init__(self):
        self.level = None
        self.filling = False
        self.valve = rospy.Publisher("~valve", Float32, queue_size=1)
        self.litres = rospy.Publisher("~litres", Float32, queue_size=1)
        self.status = rospy.Publisher("~status", String, queue_size=1)
        rospy.Subscriber("tank/echo", Range, self.on_echo)
        rospy.Subscriber("hydrant/docked", Bool, self.on_docked)
        rospy.Timer(rospy.Duration(2.0), self.report)

    def on_docked(self, msg):
        if msg.data and not self.filling:
            self.filling = True
            self.status.publish("filling")

    def on_echo(self, msg):
        if msg.range < self.BLIND:
            return
        level = self.SENSOR_HEIGHT - msg.range
        self.level = level if self.level is None else self.level + 0.5 * (level - self.level)
        if self.filling:
            self.valve.publish(self.opening())

    def opening(self):
        missing = self.FULL - self.level
        if missing <= 0.0:
            self.filling = False
            self.status.publish("full")
            return 0.0
        return 1.0 if missing > self.TRICKLE else 0.2

    def volume(self):
        """Return the litres for the level, from the table."""
        for (low, few), (high, many) in zip(self.LITRES, self.LITRES[1:]):
            if self.level < high:
                return few + (many - few) * (self.level - low) / (high - low)
        return self.LITRES[-1][1]

    def report(self, event):
        if self.level is not None:
            self.litres.publish(self.volume())


if __name__ == "__main__":
    rospy.init_node("bowser")
    BowserFiller()
    rospy.spin()
