#!/usr/bin/env python3
"""Drive a warehouse vehicle up to the wall of its bay and stop there."""

import rospy
from sensor_msgs.msg import Range
from std_msgs.msg import Float32, Float64

gap = None
load = 0.0


def on_range(msg):
    """Store the distance to the wall, m."""
    global gap
    gap = msg.range


def on_load(msg):
    """Store the load on the fork, kg."""
    global load
    load = msg.data


def wanted_speed(distance):
    """Return the approach speed, m/s."""
    left = distance - 0.4
    wanted = 0.9 * left
    if load > 250:
        wanted = min(wanted, 1.3)
    return max(-0.3, min(1.6, wanted))


if __name__ == "__main__":
    rospy.init_node("vehicle")
    rospy.Subscriber("/range", Range, on_range)
    rospy.Subscriber("/load", Float32, on_load)
    wheels = rospy.Publisher("/wheels", Float64, queue_size=1)
    rate = rospy.Rate(10)
    speed = 0.0
    while not rospy.is_shutdown():
        if gap is not None:
            change = wanted_speed(gap) - speed
            change = max(-0.2, min(0.15, change))
            speed = speed + change
            turns = speed / 0.05
            wheels.publish(turns)
        rate.sleep()
