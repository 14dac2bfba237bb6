"""The node of all worlds in this folder: go to a goal."""

import rospy
from std_msgs.msg import Float64

GAIN = 0.6


class Mover:
    """Answers each position with a speed."""

    def __init__(self):
        self.speed = rospy.Publisher("/speed", Float64, queue_size=1)
        rospy.Subscriber("/place", Float64, self.on_place)

    def on_place(self, message):
        """Slow down near the goal."""
        gap = 5.0 - message.data
        self.speed.publish(min(1.0, GAIN * gap))


if __name__ == "__main__":
    rospy.init_node("mover")
    Mover()
    rospy.spin()
