#!/usr/bin/env python3
"""Keep a buoy's heading with one thruster."""

import rospy
from std_msgs.msg import Float64


class Keeper:
    """Heading to thrust."""

    def __init__(self):
        self.gain = 0.8
        self.most = 1.0
        self.wanted = None
        self.thrust = rospy.Publisher("thrust", Float64, queue_size=1)
        rospy.Subscriber("wanted", Float64, self.on_wanted)
        rospy.Subscriber("heading", Float64, self.on_heading)

    def on_wanted(self, msg):
        """Store the heading to keep, rad."""
        self.wanted = msg.data

    def on_heading(self, msg):
        """Thrust towards the wanted heading."""
        if self.wanted is None:
            return
        turn = self.gain * (self.wanted - msg.data)
        self.thrust.publish(Float64(max(-self.most, min(self.most, turn))))


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
    rospy.spin()
