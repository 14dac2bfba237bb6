#!/usr/bin/env python3
"""Lower a load to the requested height; constants come from the parameter server."""

import rospy
from std_msgs.msg import Float64


class Winch:
    """Compute the speed of the drum from the height."""

    def __init__(self):
        self.gain = rospy.get_param("~gain", 1.5)
        self.fastest = rospy.get_param("~fastest", 0.8)
        self.goal = None
        self.drum = rospy.Publisher("drum", Float64, queue_size=1)
        rospy.Subscriber("goal", Float64, self.on_goal)
        rospy.Subscriber("height", Float64, self.on_height)

    def on_goal(self, msg):
        """Store the target height, m."""
        self.goal = msg.data

    def speed(self, left):
        """Return the speed for the remaining distance, m/s."""
        return max(-self.fastest, min(self.fastest, self.gain * left))

    def on_height(self, msg):
        """Turn the drum."""
        if self.goal is not None:
            self.drum.publish(Float64(self.speed(self.goal - msg.data)))


if __name__ == "__main__":
    rospy.init_node("winch")
    Winch()
    rospy.spin()
