#!/usr/bin/env python3
"""Drive a delivery robot back and forth between two goals on a straight track."""

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

GOALS = (11.0, 1.0)  # where to go, in turn: m along the track
TOLERANCE = 0.05  # a goal is reached this close to it: m

pos = None


def callback(msg):
    """Remember where the robot is."""
    global pos
    pos = msg.pose.pose.position.x


def travel(goal, pub):
    """Drive to a goal."""
    rate = rospy.Rate(10)
    err = float("inf")
    while err > TOLERANCE and not rospy.is_shutdown():
        delta = goal - pos
        err = abs(delta)
        vel = 5 * delta
        pub.publish(vel)
        rate.sleep()


if __name__ == "__main__":
    rospy.init_node("traveller")
    rospy.Subscriber("/odom", Odometry, callback)
    velocity = rospy.Publisher("/wheel_velocity", Float64, queue_size=1)
    rospy.on_shutdown(lambda: velocity.publish(0.0))
    try:
        while pos is None:
            rospy.sleep(0.1)
        while not rospy.is_shutdown():
            for place in GOALS:
                travel(place, velocity)
    except rospy.ROSInterruptException:
        pass
