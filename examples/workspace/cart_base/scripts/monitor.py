#!/usr/bin/env python3
"""Publish how far the cart is from its line."""

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

if __name__ == "__main__":
    rospy.init_node("monitor")
    error = rospy.Publisher("line_error", Float64, queue_size=1)
    rospy.Subscriber("odom", Odometry, lambda odom: error.publish(abs(odom.pose.pose.position.y)))
    rospy.spin()
