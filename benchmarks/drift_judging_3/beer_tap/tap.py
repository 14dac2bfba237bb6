#!/usr/bin/env python3
"""Pour a beer: tilt the glass, open the valve, stop when the scale says so."""

import rospy
from std_msgs.msg import Bool, Float32, UInt16

ML_PER_GRAM = 0.99
SOFT_END = 70.0  # volume before the mark at which the valve starts to close (ml)
DRIP = 4.0  # volume that still flows after the valve has closed (ml)
TILT = 45.0  # deg
STRAIGHT_FROM = 0.55  # as a share of the order

order = None
poured = 0.0


def on_order(msg):
    """Start with the new glass under the tap."""
    global order
    order = msg.data


def on_scale(msg):
    """Store the grams of beer, without the glass."""
    global poured
    poured = msg.data * ML_PER_GRAM


def tilt_of(full):
    """Hold the glass tilted, and straighten it slowly once it fills."""
    if full < STRAIGHT_FROM:
        return TILT
    return TILT * max(0.0, 1.0 - (full - STRAIGHT_FROM) / 0.3)


def main():
    """Serve until shutdown."""
    rospy.init_node("tap")
    rospy.Subscriber("bar/order", UInt16, on_order)
    rospy.Subscriber("bar/scale", Float32, on_scale)
    valve = rospy.Publisher("tap/valve", Float32, queue_size=1)  # from 0 to 1; the driver saturates
    tilt = rospy.Publisher("tap/tilt", Float32, queue_size=1)
    served = rospy.Publisher("bar/served", Bool, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        if order is not None:
            left = order - poured - DRIP
            tilt.publish(tilt_of(poured / order))
            if left > 1.0:
                valve.publish(left / SOFT_END)
            else:
                valve.publish(0.0)
                served.publish(True)
        rate.sleep()


if __name__ == "__main__":
    main()
