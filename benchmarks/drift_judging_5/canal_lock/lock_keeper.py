#!/usr/bin/env python3
"""Keeper of a small canal lock that raises boats: fill gently, fill fully, open the gate."""

import rospy
from std_msgs.msg import Bool, Float32

GENTLE = 0.4  # opening of the sluice while the fall is high
FULL = 1.0
CALM = 0.4  # fall below which the sluice may be fully open (m)
LEVEL = 0.04  # fall at which the gate can be moved (m)

fall = None
occupied = False


def on_fall(msg):
    global fall
    fall = msg.data


def on_boat(msg):
    global occupied
    occupied = msg.data


def waiting(sluice, _gate):
    sluice.publish(0.0)
    if occupied and fall is not None:
        return "gentle"
    return "waiting"


def gentle(sluice, _gate):
    sluice.publish(GENTLE)
    return "gentle" if fall > CALM else "full"


def full(sluice, _gate):
    sluice.publish(FULL)
    return "full" if fall > LEVEL else "open"


def opened(sluice, gate):
    sluice.publish(0.0)
    gate.publish(True)
    return "open"


STATES = {"waiting": waiting, "gentle": gentle, "full": full, "open": opened}


def main():
    global fall, occupied
    fall, occupied = None, False
    rospy.init_node("lock_keeper")
    sluice = rospy.Publisher("lock/sluice", Float32, queue_size=1)
    gate = rospy.Publisher("lock/gate", Bool, queue_size=1, latch=True)
    rospy.Subscriber("lock/fall", Float32, on_fall)
    rospy.Subscriber("lock/boat", Bool, on_boat)
    state = "waiting"
    rate = rospy.Rate(rospy.get_param("~hz", 4))
    while not rospy.is_shutdown():
        after = STATES[state](sluice, gate)
        if after != state:
            rospy.loginfo("%s -> %s", state, after)
            state = after
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
