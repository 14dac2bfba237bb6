"""A message, or a copy of it, contains no received data once every field was overwritten."""

import copy

import rospy
from geometry_msgs.msg import Twist, TwistStamped, Vector3
from std_msgs.msg import Float64


def on_deep(msg):
    twist = copy.deepcopy(msg)
    twist.linear.x = twist.linear.y = twist.linear.z = 0.0
    twist.angular.x = twist.angular.y = 0.0
    out.publish(twist)  # sink deep
    twist.angular.z = 0.0
    out.publish(twist)  # clean


def on_vectors(msg):
    twist = copy.deepcopy(msg)
    twist.linear = Vector3(0, 0, 0)
    out.publish(twist)  # sink vectors
    twist.angular = Vector3(0, 0, 0)
    out.publish(twist)  # clean


def on_value(msg):
    value.publish(msg)  # sink value
    msg.data = 1.0
    value.publish(msg)  # clean


def on_stamped(msg):
    stamped = copy.copy(msg)
    stamped.twist = Twist()
    stampeds.publish(stamped)  # sink stamped
    if msg.twist.linear.x > 1.0:
        stamped.header.frame_id = "base"
    stampeds.publish(stamped)  # sink stamped


out = rospy.Publisher("out", Twist, queue_size=1)
value = rospy.Publisher("value", Float64, queue_size=1)
stampeds = rospy.Publisher("stamped", TwistStamped, queue_size=1)
rospy.Subscriber("deep", Twist, on_deep)  # source deep
rospy.Subscriber("vectors", Twist, on_vectors)  # source vectors
rospy.Subscriber("value", Float64, on_value)  # source value
rospy.Subscriber("stamped", TwistStamped, on_stamped)  # source stamped
rospy.spin()
