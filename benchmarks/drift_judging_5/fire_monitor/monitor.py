#!/usr/bin/env python3
"""Fire monitor: points a water cannon at the hottest spot until the fire is out."""

import rospy
from ballistics import elevation
from geometry_msgs.msg import Point
from std_msgs.msg import Bool, Float32

ALPHA = 0.3  # weight of a new value in the smoothed distance


class Monitor:
    def __init__(self):
        self.far = None
        self.out = False
        self.pointing = rospy.Publisher("monitor/elevation", Float32, queue_size=1)
        self.turning = rospy.Publisher("monitor/azimuth", Float32, queue_size=1)
        self.valve = rospy.Publisher("monitor/valve", Bool, queue_size=1, latch=True)
        self.bearing = 0.0
        rospy.Subscriber("camera/hotspot", Point, self.seen)
        rospy.Subscriber("camera/out", Bool, self.on_out)

    def seen(self, spot):
        """Store the bearing and the smoothed distance; x is ahead, y is to the left."""
        raw = (spot.x**2 + spot.y**2) ** 0.5
        self.bearing = spot.y / spot.x
        self.far = raw if self.far is None else self.far + ALPHA * (raw - self.far)

    def on_out(self, msg):
        if msg.data and not self.out:
            self.out = True
            self.valve.publish(False)

    def aim(self):
        self.turning.publish(self.bearing)
        self.pointing.publish(elevation(self.far))

    def loop(self):
        rate = rospy.Rate(5)
        while not rospy.is_shutdown():
            if self.far is not None and not self.out:
                self.aim()
                self.valve.publish(True)
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("monitor")
    Monitor().loop()
