import copy
from copy import deepcopy

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64


class Copies:
    def __init__(self):
        self.template = Twist()
        self.last = Twist()
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("speed", Float64, self.on_speed)  # source speed
        rospy.Subscriber("cmd", Twist, self.on_cmd)  # source cmd

    def on_speed(self, msg):
        cmd = deepcopy(self.template)
        cmd.linear.x = msg.data
        self.pub.publish(cmd)  # sink speed
        self.pub.publish(self.template)  # clean
        other = copy.copy(cmd)
        self.pub.publish(other)  # sink speed
        other = copy.deepcopy(cmd)
        other.linear.x = 0.0
        self.pub.publish(other)  # clean
        self.pub.publish(cmd)  # sink speed

    def on_cmd(self, msg):
        self.last = copy.deepcopy(msg)
        self.last.angular.z = 0.0
        self.pub.publish(self.last)  # sink cmd
        twin = Twist()
        twin.linear = msg.linear
        self.pub.publish(twin)  # sink cmd
        still = Twist()
        still.linear.x = float(self.template.linear.x)
        self.pub.publish(still)  # clean


rospy.init_node("copies")
Copies()
rospy.spin()
