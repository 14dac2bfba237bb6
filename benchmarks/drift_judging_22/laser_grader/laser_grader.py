#!/usr/bin/env python
"""Laser grader: a receiver on the mast of the blade sees the plane of a rotating laser, and the blade follows it."""

import rospy
from std_msgs.msg import Bool, Float32

GAIN = 12.0  # valve per m
MAX_VALVE = 1.0
LOST = 0.5  # s without the beam
BENCH = 0.0  # m, the cut below the plane that the surveyor set

receiver = {"offset": None, "stamp": 0.0}
auto = False
valve_pub = None
lamp_pub = None


def receiver_cb(msg):
    receiver["offset"] = msg.data
    receiver["stamp"] = rospy.get_time()


def auto_cb(msg):
    global auto
    auto = msg.data


def has_beam():
    return receiver["offset"] is not None and rospy.get_time() - receiver["stamp"] < LOST


def control(event):
    if not auto or not has_beam():
        valve_pub.publish(0.0)
        lamp_pub.publish(False)
        return
    error = BENCH - receiver["offset"]
    valve = GAIN * error
    valve_pub.publish(max(-MAX_VALVE, min(MAX_VALVE, valve)))
    lamp_pub.publish(abs(error) < 0.01)


def main():
    global valve_pub, lamp_pub
    rospy.init_node("laser_grader")
    valve_pub = rospy.Publisher("blade/valve", Float32, queue_size=1)
    lamp_pub = rospy.Publisher("cab/lamp", Bool, queue_size=1)
    rospy.Subscriber("mast/offset", Float32, receiver_cb)
    rospy.Subscriber("cab/auto", Bool, auto_cb)
    rospy.Timer(rospy.Duration(0.1), control)
    rospy.spin()


if __name__ == "__main__":
    main()
