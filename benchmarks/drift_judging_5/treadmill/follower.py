#!/usr/bin/env python3
"""Treadmill for rehabilitation: the belt follows the walker, so that the walker stays in its middle."""

import rospy
from pid import Pid
from std_msgs.msg import Bool, Float32

GAINS = {"kp": 2.2, "ki": 1.6, "kd": 0.2}
START = 1.0  # m/s
FASTEST = 2.4


class Treadmill:
    def __init__(self):
        self.pid = Pid(**GAINS)
        self.hz = 10.0
        self.place = 0.0
        self.stopped = False
        self.belt = rospy.Publisher("belt/speed", Float32, queue_size=1)
        rospy.Subscriber("walker/place", Float32, self.on_place)
        rospy.Subscriber("handrail/stop", Bool, self.on_stop)

    def on_place(self, msg):
        self.place = msg.data  # place in front of the middle (m)

    def on_stop(self, msg):
        self.stopped = self.stopped or msg.data

    def speed(self):
        if self.stopped:
            return 0.0
        return START + self.pid.update(self.place, 1.0 / self.hz)

    def run(self):
        rate = rospy.Rate(self.hz)
        while not rospy.is_shutdown():
            self.belt.publish(min(FASTEST, max(0.0, self.speed())))
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("treadmill")
    Treadmill().run()
