#!/usr/bin/env python3
"""Carry a tray of glasses along a corridor; slow down near people and wait for them."""

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Range

PACE = 0.8  # m/s
SLOWING = 1.0  # speed per remaining metre, 1/s
STOP = 0.6  # m
LOST = 0.5  # time without a reading after which the robot stops, s


class Courier:
    """Store the latest range and send a command ten times a second."""

    def __init__(self):
        self.range = None
        self.heard = rospy.Time(0)
        self.drive = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("/front", Range, self.on_range)

    def on_range(self, msg):
        """Store the distance to the nearest object ahead, m."""
        self.range = min(msg.range, msg.max_range)
        self.heard = rospy.Time.now()

    def speed(self):
        """Return the speed for this cycle."""
        if self.range is None:
            return 0.0
        if (rospy.Time.now() - self.heard).to_sec() > LOST:
            return 0.0
        wanted = SLOWING * (self.range - STOP)
        return max(0.0, min(PACE, wanted))

    def run(self):
        """Drive until it is interrupted."""
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            cmd = Twist()
            cmd.linear.x = self.speed()
            self.drive.publish(cmd)
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("courier")
    Courier().run()
