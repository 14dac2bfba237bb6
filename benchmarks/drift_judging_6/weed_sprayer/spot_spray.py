#!/usr/bin/env python
"""Spot spraying: open a nozzle when it is above green plants between the rows."""

import rospy
from std_msgs.msg import Bool, Float32

GREEN = 0.30  # share of green pixels below the camera
RELEASE = 0.22
MIN_OPEN = 0.15  # a shorter pulse does not form a jet (s)


class SpotSprayer:
    def __init__(self):
        self.open = False
        self.opened_at = 0.0
        self.speed = 0.0
        self.nozzle = rospy.Publisher("nozzle/open", Bool, queue_size=1)
        rospy.Subscriber("rover/speed", Float32, self.on_speed)
        rospy.Subscriber("camera/green", Float32, self.on_green)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_green(self, msg):
        now = rospy.get_time()
        if self.speed < 0.1:
            self.open = False
        elif not self.open and msg.data > GREEN:
            self.open = True
            self.opened_at = now
        elif self.open and msg.data < RELEASE and now - self.opened_at >= MIN_OPEN:
            self.open = False
        self.nozzle.publish(Bool(data=self.open))


def main():
    rospy.init_node("spot_sprayer")
    SpotSprayer()
    rospy.spin()


if __name__ == "__main__":
    main()
