#!/usr/bin/env python3
"""Cut loaves on a belt in their middle: a light barrier detects each loaf, and the knife falls some time later."""

import rospy
from std_msgs.msg import Bool, Empty


class Knife:
    """Store the arrival times of loaves and cut each loaf in turn."""

    def __init__(self):
        self.way = rospy.get_param("~way", 0.6)  # distance from light barrier to knife (m)
        self.belt = rospy.get_param("~belt", 0.5)  # m/s
        self.loaf = rospy.get_param("~loaf", 0.24)  # length of a loaf (m)
        self.lead = rospy.get_param("~lead", 0.05)  # time that the knife takes to fall, s
        self.blocked = False
        self.due = []
        rospy.Subscriber("/barrier", Bool, self.on_barrier)
        self.blade = rospy.Publisher("/cut", Empty, queue_size=5)

    def on_barrier(self, msg):
        """Store the state of the light barrier, and schedule the cut of a new loaf."""
        if msg.data and not self.blocked:
            delay = (self.way + 0.5 * self.loaf) / self.belt - self.lead
            self.due.append(rospy.get_time() + delay)
        self.blocked = msg.data

    def run(self):
        """Cut until it is interrupted."""
        rate = rospy.Rate(20)
        while not rospy.is_shutdown():
            if self.due and rospy.get_time() >= self.due[0]:
                self.due.pop(0)
                self.blade.publish(Empty())
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("knife")
    Knife().run()
