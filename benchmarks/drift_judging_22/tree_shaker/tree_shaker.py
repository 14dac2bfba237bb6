#!/usr/bin/env python
"""Tree shaker: clamps a trunk, sweeps the frequency of its eccentric weights through the resonance, and lets go."""

import rospy
from std_msgs.msg import Bool, Float32, String
from std_srvs.srv import Trigger, TriggerResponse


class TreeShaker(object):
    START_HZ = 10.0
    END_HZ = 16.0
    SWEEP = 6.0  # s
    THROW = 0.5  # of the largest eccentricity
    SPIN_DOWN = 1.0  # s until the weights stand still

    def __init__(self):
        self.clamped_at = None
        self.freq_pub = rospy.Publisher("~frequency", Float32, queue_size=1)
        self.throw_pub = rospy.Publisher("~throw", Float32, queue_size=1)
        self.phase_pub = rospy.Publisher("~phase", String, queue_size=1)
        rospy.Subscriber("clamp/closed", Bool, self.clamp_cb)
        rospy.Service("~abort", Trigger, self.abort)
        self.timer = rospy.Timer(rospy.Duration(0.1), self.update)

    def clamp_cb(self, msg):
        if msg.data and self.clamped_at is None:
            self.clamped_at = rospy.get_time()
        if not msg.data:
            self.clamped_at = None

    def abort(self, request):
        self.clamped_at = None
        self.command(0.0, 0.0, "aborted")
        return TriggerResponse(success=True, message="weights stop")

    def command(self, frequency, throw, phase):
        self.freq_pub.publish(frequency)
        self.throw_pub.publish(throw)
        self.phase_pub.publish(phase)

    def sweep(self, t):
        return self.START_HZ + (self.END_HZ - self.START_HZ) * t / self.SWEEP

    def update(self, event):
        if self.clamped_at is None:
            return
        t = rospy.get_time() - self.clamped_at
        if t < self.SWEEP:
            self.command(self.sweep(t), self.THROW, "shaking")
        elif t < self.SWEEP + self.SPIN_DOWN:
            self.command(0.0, 0.0, "spin down")
        else:
            self.command(0.0, 0.0, "release")


if __name__ == "__main__":
    rospy.init_node("shaker")
    shaker = TreeShaker()
    rospy.spin()
