#!/usr/bin/env python3
"""Keep the cart on its line."""

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry


class Keeper:
    """Answers each odometry message with a command."""

    def __init__(self):
        self.gain = rospy.get_param("~gain", 0.8)
        self.command = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)

    def on_odom(self, odom):
        """Steer against the distance from the line."""
        command = Twist()
        command.linear.x = 0.3
        command.angular.z = -self.gain * odom.pose.pose.position.y
        self.command.publish(command)


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
    rospy.spin()
