#!/usr/bin/env python3
"""Drive a vibratory bowl feeder at constant frequency; control the amplitude by the rate of parts at the exit."""

import rospy
from std_msgs.msg import Bool, Float64, UInt32


class BowlFeeder:
    """P controller with a feed-forward; the magnets run at one frequency."""

    def __init__(self):
        self.frequency = rospy.get_param("~frequency", 50.0)  # Hz
        self.feed_forward = rospy.get_param("~feed_forward", 0.45)
        self.kp = rospy.get_param("~kp", 0.06)
        self.max_amplitude = rospy.get_param("~max_amplitude", 1.0)
        self.wanted_rate = rospy.get_param("~wanted_rate", 9.0)  # parts per s
        self.window = rospy.get_param("~window", 0.8)  # s
        self.soft_start = rospy.get_param("~soft_start", 2.5)  # amplitude per s
        self.amplitude = 0.0
        self.order = None
        self.counted = 0
        self.recent = []
        self.period = 0.05
        rospy.Subscriber("order", UInt32, self.order_cb)
        rospy.Subscriber("exit/count", UInt32, self.count_cb)
        self.frequency_pub = rospy.Publisher("magnets/frequency", Float64, queue_size=1)
        self.amplitude_pub = rospy.Publisher("magnets/amplitude", Float64, queue_size=1)
        self.full_pub = rospy.Publisher("full", Bool, queue_size=1)
        self.timer = rospy.Timer(rospy.Duration(self.period), self.timer_cb)

    def order_cb(self, msg):
        """Store the number of parts that the machine needs."""
        self.order = msg.data

    def count_cb(self, msg):
        """Store the number of parts that have left the bowl."""
        self.counted = msg.data
        now = rospy.get_time()
        self.recent.append((now, msg.data))
        while self.recent[0][0] < now - self.window:
            self.recent.pop(0)

    def rate(self):
        """Return the parts per second over the window."""
        if len(self.recent) < 2:
            return 0.0
        (t0, n0), (t1, n1) = self.recent[0], self.recent[-1]
        return (n1 - n0) / max(t1 - t0, self.period)

    def timer_cb(self, _event):
        """Command the magnets."""
        if self.order is None:
            return
        if self.counted >= self.order:
            self.amplitude_pub.publish(0.0)
            self.full_pub.publish(True)
            return
        target = self.feed_forward + self.kp * (self.wanted_rate - self.rate())
        target = min(self.max_amplitude, max(0.0, target))
        most = self.soft_start * self.period
        self.amplitude += max(-most, min(most, target - self.amplitude))
        self.frequency_pub.publish(self.frequency)
        self.amplitude_pub.publish(self.amplitude)


if __name__ == "__main__":
    rospy.init_node("bowl_feeder")
    BowlFeeder()
    rospy.spin()
