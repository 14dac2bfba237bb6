#!/usr/bin/env python
"""Wildlife camera on a zip line: ride down to a mark above the water hole, brake, take the pictures."""

import math

import rospy
from braking import stopping_distance
from geometry_msgs.msg import Vector3
from std_msgs.msg import Bool, Float64, String

RATE = 10
CRUISE = 4.0
SOFT_START = 1.5  # largest step of the speed at which the camera does not swing (m/s)

mark = None
place = None
speed = 0.0
slope = 0.0
braking = False
shots = 0


def mark_callback(msg):
    global mark
    mark = msg.data


def encoder_callback(msg):
    """Store x, the metres of rope since the start, and y, the metres per second."""
    global place, speed
    place = msg.x
    speed = 0.6 * speed + 0.4 * msg.y


def rope_callback(msg):
    """Store the angle of the rope here, from the inclinometer (degrees)."""
    global slope
    slope = math.radians(msg.data)


def wanted_speed():
    """Start softly, then cruise."""
    return min(CRUISE, speed + SOFT_START)


def main():
    global braking, shots
    rospy.init_node("trolley")
    rospy.Subscriber("mission/mark", Float64, mark_callback)
    rospy.Subscriber("trolley/encoder", Vector3, encoder_callback)
    rospy.Subscriber("rope/inclination", Float64, rope_callback)
    drive = rospy.Publisher("trolley/speed", Float64, queue_size=1)
    brake = rospy.Publisher("trolley/brake", Bool, queue_size=1)
    camera = rospy.Publisher("camera/trigger", Bool, queue_size=1)
    state = rospy.Publisher("trolley/state", String, queue_size=1)
    rate = rospy.Rate(RATE)
    while not rospy.is_shutdown():
        if mark is None or place is None:
            rate.sleep()
            continue
        left = mark - place
        if not braking and left <= stopping_distance(speed, slope):
            rospy.loginfo("braking %.1f m before the mark", left)
            braking = True
        if braking:
            brake.publish(True)
            drive.publish(0.0)
            state.publish("brake")
            if speed < 0.05:
                camera.publish(True)
                shots += 1
        else:
            brake.publish(False)
            drive.publish(wanted_speed())
            state.publish("ride")
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
