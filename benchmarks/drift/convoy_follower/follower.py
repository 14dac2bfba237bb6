#!/usr/bin/env python3
"""Follow the vehicle in front closely without touching it."""

import rospy
from sensor_msgs.msg import Range
from std_msgs.msg import Float64

NEAR = 5.0  # distance between standing vehicles (m)
HEADWAY = 0.5  # s
GAP_GAIN = 0.5  # 1/s²
SPEED_GAIN = 1.0  # 1/s
STRONGEST = 2.5  # largest acceleration (m/s²)
EMERGENCY = -8.0  # m/s²


class Follower:
    """Compute the acceleration from range and speed."""

    def __init__(self, soon=1.0):
        self.soon = soon
        self.gap = None
        self.closing = 0.0
        self.speed = 0.0
        self.out = rospy.Publisher("/acceleration", Float64, queue_size=1)
        rospy.Subscriber("/speed", Float64, self.on_speed)
        rospy.Subscriber("/range", Range, self.on_range)

    def on_speed(self, msg):
        """Store the speed of this vehicle, m/s."""
        self.speed = msg.data

    def on_range(self, msg):
        """Store the distance to the vehicle in front."""
        if self.gap is not None:
            closing = (self.gap - msg.range) / 0.1
            self.closing += 0.4 * (closing - self.closing)
        self.gap = msg.range
        self.out.publish(self.acceleration())

    def acceleration(self):
        """Return the acceleration, negative to brake, m/s²."""
        if self.closing > 0.5:
            left = self.gap / self.closing
            if left < self.soon:
                return EMERGENCY
        wanted = NEAR + HEADWAY * self.speed
        change = GAP_GAIN * (self.gap - wanted) - SPEED_GAIN * self.closing
        return max(-4.0, min(STRONGEST, change))


if __name__ == "__main__":
    rospy.init_node("follower")
    Follower()
    rospy.spin()
