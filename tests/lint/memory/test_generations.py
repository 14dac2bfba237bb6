"""Objects that replace each other, each made by a method of the one before, are represented by few objects."""

from __future__ import annotations

import pytest

from tarl_lint.interpret.call_contexts import ROOT_CALL
from tarl_lint.memory import generations, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import ClassInfo
from tests.lint.models.marked import differing

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# Programs, each below its title.
PROGRAMS = """\
### sums of vectors
class Vector:
    def __init__(self, x):
        self.x = x
    def __add__(self, other):
        return Vector(self.x + other.x)
total, other = Vector(0.0), Vector(0.0)
def on(msg):
    global total, other
    total = total + Vector(msg.data)
    other = other + Vector(1.0)
    out.publish(total.x)  # data
    out.publish(other.x)  # clean
rospy.Subscriber("in", Float64, on)
### states that make the next one
class State:
    def __init__(self, door):
        self.door = door
    def enter(self):
        out.publish(type(self).__name__)  # control
class Closed(State):
    def next(self, opens):
        return Opened(self.door) if opens else self
class Opened(State):
    def next(self, opens):
        return self if opens else Closed(self.door)
class Door:
    def __init__(self):
        self.state = Closed(self)
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        new = self.state.next(msg.data > 0.5)
        if new is not self.state:
            self.state = new
            self.state.enter()
Door()
### a chain of few objects keeps them apart
class Part:
    def __init__(self, value):
        self.value = value
    def then(self, value):
        return Part(value)
def on(msg):
    first = Part(1.0)
    second = first.then(msg.data)
    third = second.then(2.0)
    out.publish(first.value)  # clean
    out.publish(second.value)  # data
    out.publish(third.value)  # clean
rospy.Subscriber("in", Float64, on)
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_programs_with_chains_of_objects_have_the_marked_flows(title):
    assert differing(HEAD + CASES[title]) == {}


def test_the_last_object_of_a_long_chain_represents_all_further_ones(ctx, frame):
    cls = recency.intern(ctx, "class", "A", "A")
    cls.info = ClassInfo("A", "A")
    site = generations.site_of(cls, frame, ROOT_CALL)
    chain = []
    for number in range(generations.MAX_ALIKE):
        assert generations.last_of_line(ctx, site, frame) is None
        chain.append(recency.intern(ctx, "instance", number))
        generations.note(ctx, chain[-1], site, frame)
        receiver = frozenset([chain[-1]])
        frame = Frame((1, 2, 3, 4, receiver), number, frame.function, frame.program, frame.module)
    assert generations.last_of_line(ctx, "elsewhere", frame) is None
    assert not any(obj.many for obj in chain)
    assert generations.last_of_line(ctx, site, frame) is chain[-1]
    assert [obj.many for obj in chain] == [False, False, True]


def test_entry_points_run_again_if_an_object_that_they_read_now_stands_for_several_objects(ctx):
    obj = recency.intern(ctx, "instance", "a")
    assert recency.single(ctx, obj)
    recency.one_of_many(ctx, obj)
    assert not recency.single(ctx, obj)
    assert ctx.store.root in ctx.pending
