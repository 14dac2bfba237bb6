#!/usr/bin/env python3
"""Turn a solar panel after the sun."""

import rospy
from std_msgs.msg import Float64

sun = None
tilt = 0.0


def on_sun(msg):
    """Store the elevation of the sun, rad."""
    global sun
    sun = msg.data


def on_tilt(msg):
    """Store the smoothed tilt of the panel, rad."""
    global tilt
    tilt = 0.4 * tilt + 0.6 * msg.data


def command(gain, limit, rest):
    """Return the turn rate, rad/s."""
    error = sun - tilt
    if abs(error) < rest:
        error = 0.0
    speed = gain * error
    return max(-limit, min(limit, speed))


if __name__ == "__main__":
    rospy.init_node("solar_tracker")
    gain = rospy.get_param("~gain", 2.0)
    limit = rospy.get_param("~limit", 0.12)
    rest = rospy.get_param("~rest", 0.01)
    motor = rospy.Publisher("/motor", Float64, queue_size=1)
    rospy.Subscriber("/sun", Float64, on_sun)
    rospy.Subscriber("/tilt", Float64, on_tilt)
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        if sun is not None:
            motor.publish(command(gain, limit, rest))
        rate.sleep()
