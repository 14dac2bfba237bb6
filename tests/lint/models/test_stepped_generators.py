"""`next` runs a generator up to its next `yield`: conditions before a `yield` decide what follows it."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Base:
    def __init__(self):
        self.scan = self.pose = 0.0
        self.steps = self.sequence()
        rospy.Subscriber("scan", Float64, self.on_scan)
        rospy.Subscriber("pose", Float64, self.on_pose)
        rospy.Timer(rospy.Duration(0.1), self.tick)
    def on_scan(self, msg):
        self.scan = msg.data
    def on_pose(self, msg):
        self.pose = msg.data
"""
BODIES = """\
### a sequence that publishes
class Robot(Base):
    def sequence(self):
        out.publish(1.0)  # clean
        while self.scan < 1.0:
            out.publish(0.2)  # scan:control
            yield
        out.publish(self.pose)  # pose:data scan:control
        yield
        out.publish(3.0)  # scan:control
    def tick(self, event):
        try:
            next(self.steps)
        except StopIteration:
            out.publish(4.0)  # scan:control
### a sequence of a fixed number of steps
class Robot(Base):
    def sequence(self):
        for number in range(3):
            yield float(number)
        yield self.pose
    def tick(self, event):
        try:
            out.publish(next(self.steps))  # pose:data
        except StopIteration:
            out.publish(4.0)  # clean
### data that is received after the generator was made
class Robot(Base):
    def sequence(self):
        yield self.scan
        yield self.pose
    def tick(self, event):
        out.publish(next(self.steps))  # scan:data pose:data
### a method of the generator
class Robot(Base):
    def sequence(self):
        yield 0.0
        yield self.pose
    def tick(self, event):
        out.publish(self.steps.__next__())  # pose:data
### one sequence inside another one
class Robot(Base):
    def approach(self):
        while self.scan < 1.0:
            yield 0.2
        return self.pose
    def sequence(self):
        found = yield from self.approach()
        yield found
        out.publish(2.0)  # scan:control
    def tick(self, event):
        out.publish(next(self.steps))  # pose:data scan:control
### sequences in a list, which end at different times
class Robot(Base):
    def sequence(self):
        return [self.blink(), self.drive()]
    def blink(self):
        while True:
            out.publish(1.0)  # clean
            yield
            out.publish(0.0)  # clean
            yield
    def drive(self):
        while self.scan < 1.0:
            yield
        out.publish(self.pose)  # pose:data scan:control
        yield
    def tick(self, event):
        for one in self.steps:
            next(one, None)
### a loop over a generator does not stop at each element
class Robot(Base):
    def sequence(self):
        return None
    def numbers(self):
        while self.scan < 1.0:
            yield 1.0
        yield 2.0
        out.publish(5.0)  # clean
    def tick(self, event):
        for number in self.numbers():
            out.publish(number)  # scan:control
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_a_generator_that_next_advances_has_the_marked_flows(body):
    assert differing_topics(f"{HEAD}{body}robot = Robot()\nrospy.spin()\n") == {}
