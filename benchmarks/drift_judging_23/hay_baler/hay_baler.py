#!/usr/bin/env python
"""Small square baler behind a driverless tractor: sets the speed for even flakes, and the pressure for firm bales."""

import rospy
from crops import expected_density, settings
from std_msgs.msg import Bool, Float32, Int32, String

STROKES = 1.5  # of the plunger per s
BALE = 0.9  # m
SHAFT_LIMIT = 0.9  # of the load that shears the bolt of the flywheel
TURN_DOWN = 0.6  # of the speed, after a stroke above the limit


def clamp(value, low, high):
    return max(low, min(high, value))


class HayBaler(object):
    def __init__(self):
        self.crop = rospy.get_param("~crop", "hay")
        self.yield_per_height = rospy.get_param(
            "~yield_per_height", 0.18
        )  # m of a bale, per m driven and m of swath
        self.max_speed = rospy.get_param("~max_speed", 2.6)  # m/s
        self.min_speed = rospy.get_param("~min_speed", 0.4)
        self.height_filter = rospy.get_param("~height_filter", 0.4)
        self.accel = rospy.get_param("~accel", 0.5)  # m/s2
        self.pressure_rate = rospy.get_param("~pressure_rate", 12.0)  # bar per s
        self.height = None
        self.moisture = None
        self.load = 0.0
        self.bales = 0
        self.length = 0.0
        self.speed = 0.0
        self.bar = 0.0
        self.running = False

        self.speed_pub = rospy.Publisher("tractor/speed", Float32, queue_size=1)
        self.pressure_pub = rospy.Publisher("channel/pressure", Float32, queue_size=1)
        self.knot_pub = rospy.Publisher("knotter/trip", Bool, queue_size=1)
        self.status_pub = rospy.Publisher("baler/status", String, queue_size=1)
        rospy.Subscriber("pto/on", Bool, self.pto_cb)
        rospy.Subscriber("swath/height", Float32, self.height_cb)
        rospy.Subscriber("channel/moisture", Float32, self.moisture_cb)
        rospy.Subscriber("plunger/load", Float32, self.load_cb)
        rospy.Subscriber("channel/star_wheel", Float32, self.star_wheel_cb)
        rospy.Subscriber("knotter/count", Int32, self.count_cb)
        self.last = rospy.get_time()
        rospy.Timer(rospy.Duration(0.5), self.control)

    def pto_cb(self, msg):
        self.running = msg.data

    def height_cb(self, msg):
        if self.height is None:
            self.height = msg.data
        self.height += self.height_filter * (msg.data - self.height)

    def moisture_cb(self, msg):
        self.moisture = msg.data

    def load_cb(self, msg):
        self.load = msg.data
        if msg.data > SHAFT_LIMIT:
            rospy.logwarn("plunger at %.2f", msg.data)

    def star_wheel_cb(self, msg):
        self.length = msg.data

    def count_cb(self, msg):
        if msg.data > self.bales:
            density = expected_density(self.crop, self.bar)
            rospy.loginfo("bale %d: about %.0f kg/m3, moisture %s", msg.data, density, self.moisture)
        self.bales = msg.data

    def wanted_speed(self):
        """Return the speed in m/s at which each stroke takes one flake."""
        flake = settings(self.crop)["flake"]
        per_metre = self.yield_per_height * max(self.height, 0.1)
        speed = flake * STROKES / per_metre
        if self.load > SHAFT_LIMIT:
            speed *= TURN_DOWN
        return clamp(speed, self.min_speed, self.max_speed)

    def control(self, event):
        now = rospy.get_time()
        dt, self.last = now - self.last, now
        if not self.running or self.height is None:
            self.speed = 0.0
            self.speed_pub.publish(0.0)
            self.status_pub.publish("waiting")
            return
        step = self.accel * dt
        self.speed += clamp(self.wanted_speed() - self.speed, -step, step)
        step = self.pressure_rate * dt
        self.bar += clamp(settings(self.crop)["bar"] - self.bar, -step, step)
        self.speed_pub.publish(self.speed)
        self.pressure_pub.publish(self.bar)
        self.knot_pub.publish(self.length >= BALE)
        self.status_pub.publish("baling")


if __name__ == "__main__":
    rospy.init_node("hay_baler")
    HayBaler()
    rospy.spin()
