"""Indexing a library object and iterating over it give unknown objects; the code that follows is analysed."""

import numpy as np
import rospy
from robot_tables import JOINTS, LIMITS
from std_msgs.msg import Float64


class Arm:
    def __init__(self):
        self.positions = None
        self.seen = None
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("state", Float64, self.on_state)  # source state
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_state(self, msg):
        self.positions = msg

    def observe(self):
        state = self.positions
        if state is None:
            return None
        return np.r_[0.0, 1.0]

    def tick(self, event):
        self.seen = self.observe()
        while self.seen is None:
            self.seen = self.observe()
        far = np.linalg.norm(self.positions.data)
        if far > 1.0:
            self.out.publish(1.0)  # sink ~state
        row = np.c_[self.positions.data, 0.0]
        self.out.publish(row[0])  # sink state
        limit = LIMITS["elbow"]
        if limit is not None:
            self.out.publish(limit)  # clean
            self.out.publish(self.positions.data)  # sink state
        for joint in JOINTS:
            if joint is not None:
                self.out.publish(self.positions.data)  # sink state


if __name__ == "__main__":
    rospy.init_node("arm")
    Arm()
    rospy.spin()
