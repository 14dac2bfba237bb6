"""The same constant on every path is not a choice: both branches store zero, or zero is the default of the field."""

import math

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float64
from turtlesim.msg import Pose


class Turtle:
    def __init__(self):
        self.pose = Pose()
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.gear = rospy.Publisher("gear", Float64, queue_size=1)
        self.there = rospy.Publisher("there", Bool, queue_size=1)
        rospy.Subscriber("pose", Pose, self.on_pose)  # source pose

    def on_pose(self, pose):
        self.pose = pose

    def away(self):
        return math.hypot(5.0 - self.pose.x, 5.0 - self.pose.y)

    def go(self):
        cmd = Twist()
        while self.away() > 0.1:
            cmd.linear.x = self.away()
            cmd.linear.y = 0
            cmd.angular.z = 0.1
            self.pub.publish(cmd)  # sink pose
            rospy.sleep(0.1)
        cmd.linear.x = 0.0
        cmd.angular.z = 0.0
        self.pub.publish(cmd)  # clean
        other = Twist()
        if self.away() > 4.0:
            other.angular.y = 1
        self.pub.publish(other)  # sink ~pose

    def shift(self):
        gear = 1.0
        if self.pose.x > 3.0:
            gear = 1.0
        self.gear.publish(gear)  # clean
        gear = 2.0 if self.pose.x > 5.0 else 1.0
        self.gear.publish(gear)  # sink ~pose
        done = Bool()
        if self.pose.x > 3.0:
            done.data = False
        self.there.publish(done)  # clean
        done.data = self.pose.x > 3.0
        self.there.publish(done)  # sink pose


rospy.init_node("turtle")
turtle = Turtle()
while not rospy.is_shutdown():
    turtle.go()
    turtle.shift()
