#!/usr/bin/env python
# Seed meter of one row: turns the metering disc in proportion to ground speed.
from collections import deque
from math import pi

import rospy
from std_msgs.msg import Bool, Float32, Int32

pulses = deque(maxlen=6)  # (time, count)
spacing = None  # distance between two seeds (m)
lowered = False


def on_pulses(msg):
    pulses.append((rospy.get_time(), msg.data))


def on_spacing(msg):
    global spacing
    spacing = msg.data


def on_lowered(msg):
    global lowered
    lowered = msg.data


def ground_speed(per_turn, diameter):
    """Return the speed in m/s, from the pulses of the gauge wheel."""
    if len(pulses) < 2:
        return 0.0
    (start, first), (end, last) = pulses[0], pulses[-1]
    if end <= start:
        return 0.0
    turns = (last - first) / float(per_turn)
    return turns * pi * diameter / (end - start)


def main():
    rospy.init_node("seed_meter")
    per_turn = rospy.get_param("~pulses_per_turn", 60)
    diameter = rospy.get_param("~wheel_diameter", 0.40)
    cells = rospy.get_param("~disc_cells", 36)
    limit = rospy.get_param("~max_rpm", 90.0)
    rospy.Subscriber("gauge_wheel/pulses", Int32, on_pulses)
    rospy.Subscriber("job/spacing", Float32, on_spacing)
    rospy.Subscriber("row/lowered", Bool, on_lowered)
    pub = rospy.Publisher("meter/rpm", Float32, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        if spacing and lowered:
            speed = ground_speed(per_turn, diameter)
            seeds = speed / spacing
            rpm = seeds / cells * 60.0
            pub.publish(Float32(min(limit, rpm)))
        else:
            pub.publish(Float32(0.0))
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
