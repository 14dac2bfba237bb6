#!/usr/bin/env python
"""Sort sheep: read the ear tag, swing the gate to the pen of the animal, and back when it is through."""

import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float32, String

PENS = {"K": "keep", "S": "sell", "V": "vet"}  # first letter of the tag
ANGLES = {"keep": 0.0, "sell": 0.6, "vet": -0.6}  # rad
LIGHT = 32.0  # lighter lambs are kept, whatever their tag says (kg)
PASSAGE = 2.4  # distance from the reader at which the tail is out of the gate (m)
WALK = 1.0  # speed of a slow sheep (m/s)
GAIN = 6.0  # 1/s
SWING_MAX = 2.5  # rad/s


class SheepGate(object):
    def __init__(self):
        self.state = "wait"
        self.angle = 0.0
        self.target = 0.0
        self.since = None
        self.weight = 0.0
        self.counts = dict.fromkeys(ANGLES, 0)
        self.motor = rospy.Publisher("gate/speed", Float32, queue_size=1)
        self.tally = rospy.Publisher("gate/tally", String, queue_size=1, latch=True)
        rospy.Subscriber("reader/tag", String, self.on_tag)
        rospy.Subscriber("crate/weight", Float32, self.on_weight)
        rospy.Subscriber("gate/joint", JointState, self.on_joint)

    def on_weight(self, msg):
        self.weight = 0.5 * self.weight + 0.5 * msg.data if self.weight > 10.0 else msg.data

    def on_joint(self, msg):
        self.angle = msg.position[0]

    def on_tag(self, msg):
        if self.state != "wait":
            rospy.logwarn("sheep %s follows too closely", msg.data)
            return
        pen = PENS.get(msg.data[:1], "vet")
        if self.weight < LIGHT and pen == "sell":
            pen = "keep"
        self.counts[pen] += 1
        self.target = ANGLES[pen]
        self.since = rospy.Time.now()
        self.state = "hold"
        self.tally.publish(",".join("%s=%d" % item for item in sorted(self.counts.items())))

    def through(self):
        """Return whether the sheep has had time to pass."""
        waited = (rospy.Time.now() - self.since).to_sec()
        return waited > PASSAGE / WALK

    def step(self):
        if self.state == "hold" and self.through():
            self.target = ANGLES["keep"]
            self.state = "back"
        elif self.state == "back" and abs(self.angle - self.target) < 0.05:
            self.state = "wait"
        speed = GAIN * (self.target - self.angle)
        self.motor.publish(max(-SWING_MAX, min(SWING_MAX, speed)))


if __name__ == "__main__":
    rospy.init_node("sheep_gate")
    gate = SheepGate()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        gate.step()
        rate.sleep()
