#!/usr/bin/env python
"""Paint the lines of a small court: drive a rectangle and turn on the spot at its corners."""

import math

import rospy
from geometry_msgs.msg import Twist
from odometry import Odometry
from std_msgs.msg import Bool, Float32MultiArray, Int32MultiArray

odom = Odometry()
court = None  # length and width in m


def encoder_callback(msg):
    odom.update(msg.data[0], msg.data[1])


def court_callback(msg):
    global court
    if court is None:
        court = tuple(msg.data)
        rospy.loginfo("court of %.1f m x %.1f m", *court)


class Marker(object):
    DRIVE_SPEED = 0.8
    CREEP_SPEED = 0.15
    TURN_SPEED = 0.9
    STEER = 1.5

    def __init__(self):
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.valve = rospy.Publisher("paint/valve", Bool, queue_size=1)
        self.finished = rospy.Publisher("paint/finished", Bool, queue_size=1, latch=True)
        self.rate = rospy.Rate(10)

    def send(self, linear, angular, paint):
        twist = Twist()
        twist.linear.x = linear
        twist.angular.z = angular
        self.cmd.publish(twist)
        self.valve.publish(Bool(paint))
        self.rate.sleep()

    def leg(self, length, heading):
        start_x, start_y = odom.x, odom.y
        while not rospy.is_shutdown():
            ahead = (odom.x - start_x) * math.cos(heading) + (odom.y - start_y) * math.sin(heading)
            left = length - ahead
            if left <= 0.02:
                break
            speed = self.CREEP_SPEED if left < 0.15 else self.DRIVE_SPEED
            self.send(speed, self.STEER * (heading - odom.heading), True)

    def corner(self, heading):
        while not rospy.is_shutdown():
            left = heading - odom.heading
            if left <= 0.02:
                break
            self.send(0.0, min(self.TURN_SPEED, 0.1 + 1.5 * left), False)

    def run(self):
        while court is None and not rospy.is_shutdown():
            self.rate.sleep()
        length, width = court
        for side in range(4):
            heading = side * math.pi / 2.0
            self.corner(heading)
            self.leg(length if side % 2 == 0 else width, heading)
        self.finished.publish(Bool(True))
        self.send(0.0, 0.0, False)


if __name__ == "__main__":
    rospy.init_node("pitch_marker")
    rospy.Subscriber("encoders", Int32MultiArray, encoder_callback)
    rospy.Subscriber("court", Float32MultiArray, court_callback)
    Marker().run()
