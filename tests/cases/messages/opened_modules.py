"""Message classes and functions from several `import *`; fields overwritten before publishing are clean."""

import rospy
from geometry_msgs.msg import *
from std_msgs.msg import *
from math import *

command = Twist()
x = 0.0


def on_range(msg):
    global x
    x = hypot(msg.data, 1.0)


def drive():
    command.linear.x = min(0.5 * x, 1.0)
    command.angular.z = atan2(x, 1.0)
    pub.publish(command)  # sink range


def halt():
    command.linear.x = 0
    command.angular.z = 0
    pub.publish(command)  # clean


rospy.init_node("opened")
pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
rospy.Subscriber("range", Float32, on_range)  # source range
while not rospy.is_shutdown():
    drive()
    halt()
    rospy.sleep(0.1)
