#!/usr/bin/env python3
"""Fires test tiles: heat up at a steady rate, soak at the cone's temperature, switch off."""

import rospy
from std_msgs.msg import Bool, Float32, String

ELEMENTS = 60.0  # heating rate of the elements at full power (K/s)
LEAK = 0.03  # heat loss of the walls, 1/s
KP = 0.004
SOAK = 12.0  # s
ROOM = 20.0


class Firing:
    """One firing, from the order to switching off."""

    def __init__(self):
        self.rate = rospy.get_param("~rate", 20.0)  # K/s
        self.peak = None
        self.temperature = None
        self.target = None
        self.elements = rospy.Publisher("kiln/duty", Float32, queue_size=1)
        self.done = rospy.Publisher("kiln/done", Bool, queue_size=1, latch=True)
        self.phase = rospy.Publisher("kiln/phase", String, queue_size=1)
        rospy.Subscriber("kiln/order", Float32, self.on_order)
        rospy.Subscriber("kiln/temperature", Float32, self.on_temperature)

    def on_order(self, msg):
        self.peak = msg.data

    def on_temperature(self, msg):
        self.temperature = msg.data
        if self.target is None:
            self.target = msg.data

    def heat(self, slope):
        wanted = slope + LEAK * (self.target - ROOM)
        duty = wanted / ELEMENTS + KP * (self.target - self.temperature)
        self.elements.publish(min(1.0, max(0.0, duty)))

    def run(self):
        tick = rospy.Rate(5)
        while self.peak is None or self.temperature is None:
            tick.sleep()
        self.phase.publish("ramp")
        while self.target < self.peak and not rospy.is_shutdown():
            self.target = min(self.peak, self.target + self.rate * 0.2)
            self.heat(self.rate)
            tick.sleep()
        self.phase.publish("soak")
        end = rospy.get_time() + SOAK
        while rospy.get_time() < end and not rospy.is_shutdown():
            self.heat(0.0)
            tick.sleep()
        self.elements.publish(0.0)
        self.phase.publish("off")
        self.done.publish(True)


if __name__ == "__main__":
    rospy.init_node("kiln")
    Firing().run()
    rospy.spin()
