#!/usr/bin/env python
"""Pasteurise milk: heat it, hold it hot in a tube, and send it on, or back if it was not hot enough."""

import rospy
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float32

SETPOINT = 74.0  # temperature at the end of the holding tube (°C)
LEGAL = 72.0
HYSTERESIS = 0.3
GAIN = 0.012  # opening of the steam valve per K
RESET = 12.0  # s
PREHEAT = 0.0135  # opening of the steam valve per K between raw milk and setpoint
OUTLIER = 6.0  # change from one reading to the next (K)
PERIOD = 2.0


class SteamValve(object):
    """A PI controller of the valve, with a feed-forward from the raw milk."""

    def __init__(self):
        self.total = 0.0

    def opening(self, error, raw):
        ahead = PREHEAT * (SETPOINT - raw)
        wanted = ahead + GAIN * (error + (self.total + error * PERIOD) / RESET)
        if 0.0 < wanted < 1.0:
            self.total += error * PERIOD
        return min(1.0, max(0.0, wanted))


class Pasteuriser(object):
    def __init__(self):
        self.valve = SteamValve()
        self.hot = None
        self.raw = 6.0
        self.rejected = 0
        self.forward = False
        self.steam = rospy.Publisher("steam/valve", Float32, queue_size=1)
        self.divert = rospy.Publisher("divert/forward", Bool, queue_size=1)
        rospy.Subscriber("holding/temperature", Temperature, self.on_hot)
        rospy.Subscriber("raw/temperature", Temperature, self.on_raw)

    def on_hot(self, msg):
        if self.hot is not None and abs(msg.temperature - self.hot) > OUTLIER and self.rejected < 3:
            self.rejected += 1
            return
        self.rejected = 0
        self.hot = msg.temperature

    def on_raw(self, msg):
        self.raw += 0.3 * (msg.temperature - self.raw)

    def direct(self):
        """Choose the way of the milk behind the holding tube."""
        if self.hot < LEGAL:
            if self.forward:
                rospy.logwarn("diverted at %.1f", self.hot)
            self.forward = False
        elif self.hot > LEGAL + HYSTERESIS:
            self.forward = True
        self.divert.publish(Bool(data=self.forward))

    def run(self):
        rate = rospy.Rate(1.0 / PERIOD)
        while not rospy.is_shutdown():
            if self.hot is not None:
                error = SETPOINT - self.hot
                self.steam.publish(Float32(data=self.valve.opening(error, self.raw)))
                self.direct()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("milk_pasteuriser")
    Pasteuriser().run()
