#!/usr/bin/env python
# shade a shop window: the awning extends further in brighter sun
import math

import rospy
from std_msgs.msg import Float64, Float64MultiArray, String

# light at the facade (klx) -> extended share of the awning
CURVE = [(20.0, 0.0), (40.0, 0.25), (60.0, 0.5), (80.0, 0.75), (100.0, 1.0)]
MAX_WIND = 12.0  # m/s

sun = None
wind = 0.0
steep = 1.0


def sun_cb(msg):
    """Store the light at the sensor above the window, klx."""
    global sun
    sun = msg.data


def wind_cb(msg):
    global wind
    wind = max(msg.data, 0.9 * wind)  # keep the effect of gusts for a while


def ephemeris_cb(msg):
    """Store [azimuth, elevation] of the sun in degrees; a low sun shines in below the awning."""
    global steep
    steep = 1.0 + 0.2 * math.cos(math.radians(msg.data[1]))


def from_curve(klx):
    """Interpolate CURVE."""
    if klx <= CURVE[0][0]:
        return CURVE[0][1]
    for (low, out_low), (high, out_high) in zip(CURVE, CURVE[1:]):
        if klx < high:
            return out_low + (out_high - out_low) * (klx - low) / (high - low)
    return CURVE[-1][1]


def wanted():
    if wind > MAX_WIND:
        return 0.0
    return min(1.0, from_curve(sun * steep))


rospy.init_node("awning")
rospy.Subscriber("facade/sun", Float64, sun_cb)
rospy.Subscriber("facade/wind", Float64, wind_cb)
rospy.Subscriber("ephemeris", Float64MultiArray, ephemeris_cb)
pub = rospy.Publisher("awning/target", Float64, queue_size=1)
say = rospy.Publisher("awning/state", String, queue_size=1)
rate = rospy.Rate(0.5)
try:
    while not rospy.is_shutdown():
        if sun is not None:
            target = wanted()
            pub.publish(target)
            say.publish("in" if target < 0.05 else "out %d%%" % (100 * target))
        rate.sleep()
except rospy.ROSInterruptException:
    pass
