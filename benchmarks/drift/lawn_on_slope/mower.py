#!/usr/bin/env python3
"""Mow a straight strip: follow it by position and compass, and slow the blade down in high grass."""

import rospy
from geometry_msgs.msg import PointStamped, Twist
from std_msgs.msg import Float32, Float64
from steering import blade_speed, limited, turn_rate

PACE = 0.6  # m/s


class Mower:
    """Store the sensor readings and send a command ten times a second."""

    def __init__(self):
        self.place = None
        self.heading = 0.0
        self.grass = 0.0
        rospy.Subscriber("/place", PointStamped, self.on_place)
        rospy.Subscriber("/compass", Float64, self.on_compass)
        rospy.Subscriber("/grass", Float32, self.on_grass)
        self.drive = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.blade = rospy.Publisher("/blade", Float32, queue_size=1)

    def on_place(self, msg):
        """Store the position of the robot."""
        self.place = msg.point

    def on_compass(self, msg):
        """Store the heading of the robot relative to the strip."""
        self.heading = msg.data

    def on_grass(self, msg):
        """Store the height of the grass, cm."""
        self.grass = 0.7 * self.grass + 0.3 * msg.data

    def command(self):
        """Return the command of the wheels."""
        cmd = Twist()
        cmd.linear.x = PACE
        if self.grass > 12.0:
            cmd.linear.x = 0.8 * PACE
        cmd.angular.z = limited(turn_rate(self.place.y, self.heading), 1.2)
        return cmd

    def run(self):
        """Mow until it is interrupted."""
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if self.place is not None:
                self.drive.publish(self.command())
                self.blade.publish(blade_speed(self.grass))
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("mower")
    Mower().run()
