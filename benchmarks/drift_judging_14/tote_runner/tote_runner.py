#!/usr/bin/env python
"""Run totes along an aisle of a warehouse. Stop in front of people, and go on when the aisle is clear."""

import math

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32, String


class ToteRunner(object):
    """State machine: IDLE, RUN, HELD (parking brake on), ARRIVED."""

    def __init__(self):
        self.stop_distance = rospy.get_param("~stop_distance", 1.2)  # m
        self.clear_time = rospy.get_param("~clear_time", 0.8)  # s
        self.cruise = rospy.get_param("~cruise", 1.2)  # m/s
        self.accel = rospy.get_param("~accel", 0.8)  # m/s2
        self.tolerance = rospy.get_param("~tolerance", 0.15)  # m
        self.rate_hz = 10.0

        self.state = "IDLE"
        self.position = 0.0
        self.goal = None
        self.speed = 0.0
        self.near = False
        self.last_near = rospy.Time(0)
        self.stops = 0

        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.brake_pub = rospy.Publisher("parking_brake", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("runner/state", String, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.odom_cb)
        rospy.Subscriber("sonar", Range, self.sonar_cb)
        rospy.Subscriber("runner/goal", Float32, self.goal_cb)

    def odom_cb(self, msg):
        self.position = msg.pose.pose.position.x

    def goal_cb(self, msg):
        if self.goal != msg.data:
            self.goal = msg.data
            self.state = "RUN"

    def sonar_cb(self, msg):
        self.near = msg.range < self.stop_distance
        if self.near:
            self.last_near = rospy.Time.now()

    def is_clear(self):
        return (rospy.Time.now() - self.last_near).to_sec() > self.clear_time

    def profile(self):
        """Next speed: up to the cruise, and down again towards the goal."""
        left = max(0.0, self.goal - self.position)
        wanted = min(self.cruise, 0.8 * math.sqrt(2.0 * self.accel * left))
        step = self.accel / self.rate_hz
        self.speed = min(wanted, self.speed + step)
        return self.speed

    def spin_once(self):
        cmd = Twist()
        if self.state == "RUN":
            if self.near:
                self.state = "HELD"
                self.speed = 0.0
                self.stops += 1
                rospy.loginfo("stop %d at %.1f m", self.stops, self.position)
            elif self.goal - self.position < self.tolerance:
                self.state = "ARRIVED"
            else:
                cmd.linear.x = self.profile()
        elif self.state == "HELD":
            if self.is_clear():
                self.state = "RUN"
        self.cmd_pub.publish(cmd)
        self.brake_pub.publish(self.state != "RUN")
        self.state_pub.publish(self.state)

    def spin(self):
        rate = rospy.Rate(self.rate_hz)
        while not rospy.is_shutdown():
            self.spin_once()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("tote_runner")
    try:
        ToteRunner().spin()
    except rospy.ROSInterruptException:
        pass
