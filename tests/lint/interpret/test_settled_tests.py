"""Tests whose result is known for some of the objects that a variable may be, and methods of these objects."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import queue, threading, rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Cast:
    kind = "cast"
    def __init__(self, length):
        self.length = length
    def run(self, boat):
        out.publish(self.length)  # plan:data {cast}
class Reel:
    kind = "reel"
    def __init__(self, speed):
        self.speed = speed
    def run(self, boat):
        out.publish(self.speed)  # plan:data{reel}
class Boat:
    def __init__(self):
        self.stormy = False
        self.skipped = 0
        self.jobs = queue.Queue()
        rospy.Subscriber("plan", Float64, self.on_plan)
        rospy.Subscriber("wind", Float64, self.on_wind)
        threading.Thread(target=self.work).start()
    def on_wind(self, msg):
        self.stormy = msg.data
    def on_plan(self, msg):
        self.jobs.put(Cast(msg.length))
        self.jobs.put(Reel(msg.speed))
    def work(self):
        while not rospy.is_shutdown():
            job = self.jobs.get()
{body}
Boat()
"""
CAST_ONLY = """\
### a conjunction
            if isinstance(job, Cast) and self.stormy:
                self.skipped += 1
                continue
            job.run(self)
### a conjunction in the other order
            if self.stormy and isinstance(job, Cast):
                continue
            job.run(self)
### a nested test
            if isinstance(job, Cast):
                if self.stormy:
                    continue
            job.run(self)
### a test in the other branch
            if isinstance(job, Reel):
                rospy.loginfo("reel")
            else:
                if self.stormy:
                    continue
            job.run(self)
### a tag in an attribute
            if job.kind == "cast" and self.stormy:
                continue
            job.run(self)
"""
BOTH = """\
### no test of the object
            if self.stormy:
                continue
            job.run(self)
### a test that ends the loop
            job.run(self)
            if isinstance(job, Cast) and self.stormy:
                break
### a test of an earlier object
            if isinstance(job, Cast) and self.stormy:
                continue
            job = self.jobs.get()
            job.run(self)
### a class whose statements have the same numbers
            if isinstance(job, Cast):
                class Record:
                    a, b, c, d = 1, 2, 3, 4
                    e = 5; f = 6; g = 7; h = 8; i = 9; j = 10; k = 11; l = 12; m = 13; n = 14; o = 15; p = 16
                    q = 17; r = 18; s = 19; t = 20; u = 21; v = 22; w = 23; x = 24; y = 25; z = 26
                self.skipped += Record.a
            if self.stormy:
                continue
            job.run(self)
### a test that may hold for both
            if (isinstance(job, Cast) or self.skipped) and self.stormy:
                continue
            job.run(self)
"""
ONE, ALL = sections(CAST_ONLY), sections(BOTH)


@pytest.mark.parametrize("name", ONE)
def test_a_test_decides_only_about_the_objects_it_may_hold_for(name: str) -> None:
    assert differing_topics(HEAD.format(cast="wind:control", reel="", body=ONE[name])) == {}


@pytest.mark.parametrize("name", ALL)
def test_other_tests_decide_about_all_objects(name: str) -> None:
    assert differing_topics(HEAD.format(cast="wind:control", reel=" wind:control", body=ALL[name])) == {}
