#!/usr/bin/env python3
"""Crawl through a pipe at a steady speed, and slower past an obstacle."""

import rospy
from std_msgs.msg import Float32, Float64


class Crawler:
    """Push as much as the speed requires, up to the grip of the wheels on the wall."""

    CRUISE = 0.4  # m/s
    CAREFUL = 0.25  # m/s
    KP = 60.0  # N per m/s
    KI = 40.0  # N per m
    PUSH_LIMIT = 24.0  # N

    def __init__(self):
        self.speed = None
        self.debris = 0.0
        self.wound = 0.0
        self.push = rospy.Publisher("/push", Float64, queue_size=1)
        self.lamp = rospy.Publisher("/lamp", Float32, queue_size=1)
        rospy.Subscriber("/debris", Float32, self.on_debris)
        rospy.Subscriber("/speed", Float64, self.on_speed)

    def on_debris(self, msg):
        """Store the amount of obstacles ahead, 0 to 1."""
        self.debris = msg.data
        self.lamp.publish(0.2 + 0.8 * self.debris)

    def on_speed(self, msg):
        """Answer the speed with a push."""
        self.speed = msg.data
        wanted = self.CRUISE
        if self.debris > 0.5:
            wanted = self.CAREFUL
        error = wanted - self.speed
        self.wound = min(0.5, self.wound + error * 0.1)
        push = self.KP * error + self.KI * self.wound
        if push > self.PUSH_LIMIT:
            push = self.PUSH_LIMIT
        self.push.publish(max(0.0, push))


if __name__ == "__main__":
    rospy.init_node("crawler")
    Crawler()
    rospy.spin()
