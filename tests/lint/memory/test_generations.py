"""Objects that replace each other, each made by a method of the previous object, are represented by few objects."""

from __future__ import annotations

import dataclasses

import pytest

from tarl_lint.interpret.call_contexts import ROOT_CALL
from tarl_lint.memory import generations, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import ClassInfo
from tests.lint.models.marked import differing, sections
from tests.lint.test_work import work

HEAD = """\
import copy, dataclasses
from typing import NamedTuple
import attr, attrs
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
CASES = sections(PROGRAMS)
# A node that replaces a record by the result of `moved`; the record's class stands above it.
MOVING = """\
class Node:
    def __init__(self):
        self.fix = Fix(0.0, 0.0)
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.fix = self.fix.moved(msg.data)
        out.publish(self.fix.north)  # data
        out.publish(self.fix.east)  # clean
Node()
"""
# the record's class → what `moved` does
RECORDS = {
    "NamedTuple": [
        "return self._replace(north=self.north + d)",
        "return type(self)(self.north + d, self.east)",
    ],
    "Data": [
        "return dataclasses.replace(self, north=self.north + d)",
        "return copy.replace(self, north=self.north + d)",
        "return changed(self, self.north + d)",
        "return self.with_north(self.north + d).with_east(1.0).with_east(2.0)",
        "return Other(self).moved(d)",
        (
            "made = self\n        for _ in range(3):\n            made = made.with_north(made.north + d)\n"
            "        return made"
        ),
    ],
    "Attrs": [
        "return attr.evolve(self, north=self.north + d)",
        "return attrs.evolve(self, north=self.north + d)",
    ],
    "Plain": [
        "made = copy.copy(self)\n        made.north += d\n        return made",
        "made = copy.deepcopy(self)\n        made.north = made.north + d\n        return made",
        'return self.__class__(**{**vars(self), "north": self.north + d})',
        (
            "made = object.__new__(Fix)\n        made.__dict__.update(vars(self))\n        made.north += d\n"
            "        return made"
        ),
    ],
}
CLASSES = {
    "NamedTuple": "class Fix(NamedTuple):\n    north: float\n    east: float\n",
    "Data": "@dataclasses.dataclass\nclass Fix:\n    north: float\n    east: float\n",
    "Attrs": "@attr.s(auto_attribs=True)\nclass Fix:\n    north: float\n    east: float\n",
    "Plain": "class Fix:\n    def __init__(self, north, east):\n        self.north = north\n        self.east = east\n",
}
OTHERS = """\
    def with_north(self, north):
        return dataclasses.replace(self, north=north)
    def with_east(self, east):
        return dataclasses.replace(self, east=east)
def changed(fix, north):
    return dataclasses.replace(fix, north=north)
@dataclasses.dataclass
class Other:
    fix: object
    def moved(self, d):
        return dataclasses.replace(self.fix, north=self.fix.north + d)
"""
CLOSURES = """\
### a closure that returns a closure
def counter(n):
    def step(msg):
        out.publish(n)  # data
        return counter(n + msg.data)
    return step
### three states that are closures
def idle(n):
    def step(msg):
        out.publish(n)  # data
        if msg.data > 2.0:
            return stopped(n)
        return running(n + msg.data) if msg.data > 1.0 else idle(n)
    return step
def running(n):
    def step(msg):
        out.publish(n)  # data
        if msg.data > 2.0:
            return stopped(n)
        return idle(n + 1.0) if msg.data > 1.0 else running(n)
    return step
def stopped(n):
    def step(msg):
        out.publish(3.0)  # control
        return idle(n) if msg.data > 1.0 else stopped(0.0)
    return step
counter = idle
### a closure that returns a closure, and passes on no data
def counter(n):
    def step(msg):
        out.publish(n)  # clean
        return counter(n + 1.0)
    return step
"""
STEPPING = """\
class Node:
    def __init__(self):
        self.step = counter(0.0)
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.step = self.step(msg)
Node()
"""
MOST_WORK = 600  # statements; without a limit on chains, these programs take from 2,600 to 80,000


@pytest.mark.parametrize("title", CASES)
def test_programs_with_chains_of_objects_have_the_marked_flows(title):
    assert differing(HEAD + CASES[title]) == {}


@pytest.mark.parametrize(("record", "body"), [(r, body) for r, bodies in RECORDS.items() for body in bodies])
def test_record_replaced_by_a_copy_takes_little_work(record, body):
    text = f"{HEAD}{CLASSES[record]}    def moved(self, d):\n        {body}\n{OTHERS}{MOVING}"
    assert differing(text) == {}
    assert work(text).total < MOST_WORK


@pytest.mark.parametrize("title", sections(CLOSURES))
def test_closure_that_replaces_itself_takes_little_work(title):
    text = HEAD + sections(CLOSURES)[title] + STEPPING
    assert differing(text) == {}
    assert work(text).total < MOST_WORK


def test_last_object_of_a_long_chain_represents_the_rest(ctx, frame):
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


def test_entry_point_runs_again_when_an_object_becomes_a_summary(ctx):
    obj = recency.intern(ctx, "instance", "a")
    assert recency.single(ctx, obj)
    recency.one_of_many(ctx, obj)
    assert not recency.single(ctx, obj)
    assert ctx.store.root in ctx.pending


def test_closures_of_one_recursive_function_share_contexts(ctx, frame):
    functions = {name: dataclasses.replace(frame.function) for name in "ab"}
    for number, name in enumerate("aba"):
        caller = frame
        frame = Frame((1, 2, 3, number, None), number, frame.function, frame.program, frame.module)
        frame.caller = caller
        assert not generations.too_many_closures(ctx, frame)
        generations.note_closure(ctx, recency.intern(ctx, "closure", number + 1), functions[name], frame)
    inner = Frame((1, 2, 3, 3, None), 9, frame.function, frame.program, frame.module)
    inner.caller = frame
    assert generations.too_many_closures(ctx, inner)
