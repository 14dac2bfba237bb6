#!/usr/bin/env python
"""Barrier of a toll lane: opens when the toll is paid, and closes behind the vehicle."""

import rospy
from std_msgs.msg import Bool, Float32, String

CLOSED, RISING, OPEN, PASSING, FALLING = range(5)
NAMES = ["closed", "rising", "open", "passing", "falling"]


class TollBarrier(object):
    def __init__(self):
        self.up_speed = rospy.get_param("~up_speed", 1.4)  # of the whole way, per second
        self.down_speed = rospy.get_param("~down_speed", 1.2)
        self.down_slow = rospy.get_param("~down_slow", 0.6)  # for the last part
        self.slow_below = rospy.get_param("~slow_below", 0.12)
        self.top = rospy.get_param("~top", 0.98)
        self.bottom = rospy.get_param("~bottom", 0.03)
        self.beam_samples = rospy.get_param("~beam_samples", 2)
        self.clear_delay = rospy.get_param("~clear_delay", 0.3)  # s
        self.give_up = rospy.get_param("~give_up", 25.0)  # s, the driver does not start
        self.lamp_before = rospy.get_param("~lamp_before", 0.9)
        self.state = CLOSED
        self.arm = 0.0
        self.paid = 0
        self.broken = 0
        self.clear_since = None
        self.opened_at = 0.0
        self.drive = rospy.Publisher("arm/speed", Float32, queue_size=1)
        self.lamp = rospy.Publisher("lamp/green", Bool, queue_size=1)
        self.info = rospy.Publisher("barrier/state", String, queue_size=1)
        rospy.Subscriber("arm/position", Float32, self.arm_cb)
        rospy.Subscriber("beam/broken", Bool, self.beam_cb)
        rospy.Subscriber("booth/paid", Bool, self.paid_cb)

    def arm_cb(self, msg):
        self.arm = msg.data

    def beam_cb(self, msg):
        self.broken = self.broken + 1 if msg.data else 0
        if self.broken:
            self.clear_since = None
        elif self.clear_since is None:
            self.clear_since = rospy.get_time()

    def paid_cb(self, msg):
        if msg.data:
            self.paid += 1

    def under(self):
        return self.broken >= self.beam_samples

    def clear_for(self):
        """Seconds since the beam was last broken."""
        if self.clear_since is None:
            return 0.0
        return rospy.get_time() - self.clear_since

    def step(self):
        now = rospy.get_time()
        speed = 0.0
        if self.state == CLOSED:
            if self.paid:
                self.paid -= 1
                self.state = RISING
        elif self.state == RISING:
            speed = self.up_speed
            if self.arm > self.top:
                self.opened_at = now
                self.state = OPEN
        elif self.state == OPEN:
            if self.under():
                self.state = PASSING
            elif now - self.opened_at > self.give_up:
                rospy.logwarn("nobody came, closing")
                self.state = FALLING
        elif self.state == PASSING:
            if self.clear_for() > self.clear_delay:
                self.state = FALLING
        elif self.state == FALLING:
            speed = -self.down_speed if self.arm > self.slow_below else -self.down_slow
            if self.under():
                rospy.logwarn("something under the arm at %.2f", self.arm)
                self.state = RISING
                speed = self.up_speed
            elif self.arm < self.bottom:
                speed = 0.0
                self.state = CLOSED
        self.drive.publish(speed)
        self.lamp.publish(self.state in (OPEN, PASSING) and self.arm > self.lamp_before)
        self.info.publish(NAMES[self.state])


if __name__ == "__main__":
    rospy.init_node("toll_barrier")
    barrier = TollBarrier()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        barrier.step()
        rate.sleep()
