#!/usr/bin/env python
"""Inspection trolley on a rail in a tunnel. Knows its place by its wheel and by tags on the sleepers."""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

TAG_SPACING = 6.0  # m
TICKS_PER_METRE = 1180.0


class RailTrolley(object):
    def __init__(self):
        self.cruise = rospy.get_param("~cruise", 1.4)  # m/s
        self.creep = rospy.get_param("~creep", 0.12)
        self.accel = rospy.get_param("~accel", 0.5)  # m/s2
        self.slow_gain = rospy.get_param("~slow_gain", 0.7)
        self.window = rospy.get_param("~window", 0.05)  # m
        self.photo_time = rospy.get_param("~photo_time", 2.0)  # s
        self.tag_gate = rospy.get_param("~tag_gate", 0.5)  # m, neighbours' tags are read as well
        self.tag_trust = rospy.get_param("~tag_trust", 0.9)
        self.max_missed = rospy.get_param("~max_missed", 12.0)  # m without a tag until it warns
        self.lamp_before = rospy.get_param("~lamp_before", 1.0)  # m
        self.position = 0.0
        self.ticks = None
        self.last_tag = 0.0
        self.rejected = 0
        self.targets = []
        self.speed = 0.0
        self.photo_until = None
        self.pub = rospy.Publisher("trolley/speed", Float32, queue_size=1)
        self.camera = rospy.Publisher("camera/shoot", Bool, queue_size=1)
        self.lamp = rospy.Publisher("camera/lamp", Bool, queue_size=1)
        self.status = rospy.Publisher("trolley/status", String, queue_size=1)
        rospy.Subscriber("wheel/ticks", Int32, self.ticks_cb)
        rospy.Subscriber("reader/tag", Int32, self.tag_cb)
        rospy.Subscriber("mission/add_target", Float32, self.target_cb)

    def ticks_cb(self, msg):
        if self.ticks is not None:
            self.position += (msg.data - self.ticks) / TICKS_PER_METRE
        self.ticks = msg.data

    def tag_cb(self, msg):
        place = msg.data * TAG_SPACING
        innovation = place - self.position
        if abs(innovation) > self.tag_gate:
            self.rejected += 1
            rospy.logwarn("tag %d is %.2f m away from where it should be, ignored", msg.data, innovation)
            return
        self.position += self.tag_trust * innovation
        self.last_tag = self.position

    def target_cb(self, msg):
        self.targets.append(msg.data)

    def approach(self, left):
        """Speed for the distance that is left, to both sides."""
        wish = max(self.creep, min(self.cruise, self.slow_gain * abs(left)))
        return wish if left > 0.0 else -min(wish, 0.4)

    def step(self, dt):
        now = rospy.get_time()
        wish, shoot, text = 0.0, False, "idle"
        left = self.targets[0] - self.position if self.targets else None
        if self.photo_until is not None:
            text = "photo"
            shoot = now > self.photo_until - 0.5 * self.photo_time
            if now > self.photo_until:
                self.photo_until = None
                self.targets.pop(0)
        elif left is not None:
            text = "drive"
            if abs(left) < self.window:
                self.photo_until = now + self.photo_time
            else:
                wish = self.approach(left)
        if abs(self.position - self.last_tag) > self.max_missed:
            rospy.logwarn_throttle(10.0, "no tag for a while, is the reader dirty?")
        change = max(-2.0 * self.accel * dt, min(self.accel * dt, wish - self.speed))
        self.speed = 0.0 if text == "photo" else self.speed + change
        self.pub.publish(self.speed)
        self.camera.publish(shoot)
        self.lamp.publish(left is not None and abs(left) < self.lamp_before)
        self.status.publish("%s %.1f" % (text, self.position))


if __name__ == "__main__":
    rospy.init_node("rail_trolley")
    trolley = RailTrolley()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        trolley.step(0.1)
        rate.sleep()
