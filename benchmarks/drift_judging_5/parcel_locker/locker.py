#!/usr/bin/env python
# -*- coding: utf-8 -*-
"""Parcel locker: opens the door that belongs to a code."""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

PULSE = 0.3  # duration of the current through the latch's coil (s)
PATIENCE = 1.5  # time within which the spring pushes the door open (s)
TRIES = 2

CODES = {"7031": 1, "4410": 2, "9256": 3, "1188": 4}


class Door(object):
    """State of the door in front of the customer."""

    number = 0
    open = False


def opens_in_time(door, patience):
    """Wait for the door's switch."""
    until = rospy.get_time() + patience
    while rospy.get_time() < until and not rospy.is_shutdown():
        if door.open:
            return True
        rospy.sleep(0.1)
    return door.open


def unlatch(coil, pulse):
    coil.publish(12.0)
    rospy.sleep(pulse)
    coil.publish(0.0)


def serve(door, coil, screen):
    """Return whether the door opened."""
    for attempt in range(TRIES):
        screen.publish("opening door %d" % door.number)
        unlatch(coil, PULSE)
        if opens_in_time(door, PATIENCE):
            screen.publish("please take your parcel")
            return True
        rospy.logwarn("door %d: attempt %d failed", door.number, attempt + 1)
    screen.publish("please call us")
    return False


def main():
    rospy.init_node("locker")
    door = Door()
    coil = rospy.Publisher("latch/voltage", Float32, queue_size=1)
    choose = rospy.Publisher("latch/door", Int32, queue_size=1, latch=True)
    screen = rospy.Publisher("screen/text", String, queue_size=5, latch=True)

    def on_code(msg):
        if msg.data in CODES and not door.number:
            door.number = CODES[msg.data]
            choose.publish(door.number)

    def on_switch(msg):
        door.open = msg.data

    rospy.Subscriber("keypad/code", String, on_code)
    rospy.Subscriber("door/open", Bool, on_switch)
    while not rospy.is_shutdown() and not door.number:
        rospy.sleep(0.1)
    serve(door, coil, screen)
    rospy.spin()


if __name__ == "__main__":
    main()
