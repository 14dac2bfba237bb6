"""Loops over objects: the answer of an object decides whether later objects are called, but not earlier objects."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy
from enum import Enum
from std_msgs.msg import Float64
Status = Enum("Status", "OK FAILED BUSY")
first = rospy.Publisher("first", Float64, queue_size=1)
second = rospy.Publisher("second", Float64, queue_size=1)
third = rospy.Publisher("third", Float64, queue_size=1)
last = {"a": 0.0, "b": 0.0}
rospy.Subscriber("a", Float64, lambda msg: last.update(a=msg.data))
rospy.Subscriber("b", Float64, lambda msg: last.update(b=msg.data))
class Leaf:
    def __init__(self, function):
        self.function = function
    def tick(self):
        return self.function()
def a():
    return Status.OK if last["a"] > 1 else Status.FAILED
def b():
    return Status.OK if last["b"] > 1 else Status.FAILED
"""
LEAVES = """
def one():
    first.publish(1.0)  # FIRST
    return Status.OK
def two():
    second.publish(1.0)  # SECOND
    return Status.OK
def three():
    third.publish(1.0)  # THIRD
    return Status.OK
"""
TAIL = """
while not rospy.is_shutdown():
    root.tick()
    rospy.sleep(0.1)
"""
# Programs, each below its title, with the marks of the three publish calls after it.
PROGRAMS = """\
### children in order of a list: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, children):
        self.children = children
    def tick(self):
        for child in self.children:
            status = child.tick()
            if status != Status.OK:
                return status
        return Status.OK
root = Sequence([Leaf(one), Leaf(a), Leaf(two), Sequence([Leaf(b), Leaf(three)])])
### children that are appended: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, children=None):
        self.children = children or []
    def add(self, child):
        self.children.append(child)
        return self
    def tick(self):
        for child in self.children:
            if child.tick() is not Status.OK:
                return Status.FAILED
        return Status.OK
root = Sequence()
root.add(Leaf(one)).add(Leaf(a)).add(Leaf(two))
inner = Sequence()
inner.add(Leaf(b))
inner.add(Leaf(three))
root.add(inner)
### children among the arguments: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, *children):
        self.children = [*children]
    def tick(self):
        for child in self.children:
            status = child.tick()
            if status is Status.OK:
                continue
            return status
        return Status.OK
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Sequence(Leaf(b), Leaf(three)))
### a selector: clean; a:control; a:control
class Selector:
    def __init__(self, *children):
        self.children = list(children)
    def tick(self):
        result = Status.FAILED
        for child in self.children:
            result = child.tick()
            if result is not Status.FAILED:
                break
        return result
class Fails(Leaf):
    def tick(self):
        self.function()
        return Status.FAILED
root = Selector(Fails(one), Leaf(a), Fails(two), Fails(three), Leaf(b))
### all children run: clean; clean; clean
class Parallel:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        good = 0
        for child in self.children:
            if child.tick() is Status.OK:
                good += 1
        return good
root = Parallel(Leaf(one), Leaf(a), Leaf(two), Leaf(b), Leaf(three))
### all of a generator: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        if all(child.tick() is Status.OK for child in self.children):
            return Status.OK
        return Status.FAILED
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Sequence(Leaf(b), Leaf(three)))
### any of a generator: clean; a:control; a:control
class Selector:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        return Status.OK if any(child.tick() is Status.OK for child in self.children) else Status.FAILED
class Fails(Leaf):
    def tick(self):
        self.function()
        return Status.FAILED
root = Selector(Fails(one), Leaf(a), Fails(two), Fails(three), Leaf(b))
### all of a list, which is complete before: clean; clean; clean
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        return all([child.tick() is Status.OK for child in self.children])
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Leaf(b), Leaf(three))
### the first one that is ready: clean; a:control; a:control b:control
class Priority:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        chosen = next((child for child in self.children if child.ready() is Status.OK), None)
        if chosen is not None:
            chosen.tick()
class Task(Leaf):
    def __init__(self, ready, function):
        self.ready = ready
        self.function = function
def asked():
    two()
    return b()
def nothing():
    pass
one()
root = Priority(Task(a, nothing), Task(asked, three))
### an exception ends the loop: clean; a:control; a:control b:control
class Stop(Exception):
    pass
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        try:
            for child in self.children:
                if child.tick() is Status.FAILED:
                    raise Stop
        except Stop:
            return Status.FAILED
        return Status.OK
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Sequence(Leaf(b), Leaf(three)))
### what follows the loop: clean; a:control b:control; clean
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        for child in self.children:
            if child.tick() is Status.FAILED:
                break
        else:
            two()
        three()
root = Sequence(Leaf(one), Leaf(a), Leaf(b))
### numbers of the children: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        for number, child in enumerate(self.children):
            if child.tick() is not Status.OK:
                self.stopped = number
                return Status.FAILED
        return Status.OK
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Sequence(Leaf(b), Leaf(three)))
### children by their number: clean; a:control; a:control b:control
class Sequence:
    def __init__(self, *children):
        self.children = children
    def tick(self):
        for number in range(len(self.children)):
            if self.children[number].tick() is not Status.OK:
                return Status.FAILED
        return Status.OK
root = Sequence(Leaf(one), Leaf(a), Leaf(two), Sequence(Leaf(b), Leaf(three)))
### a loop inside the loop: clean; a:control; a:control b:control
class Table:
    def __init__(self, *rows):
        self.rows = rows
    def tick(self):
        for row in self.rows:
            if row.empty():
                return
            for child in row.children:
                if child.tick() is Status.FAILED:
                    return
class Row:
    def __init__(self, *children):
        self.children = children
    def empty(self):
        return False
root = Table(Row(Leaf(one), Leaf(a), Leaf(two)), Row(Leaf(b), Leaf(three)))
"""


@pytest.mark.parametrize("title", sections(PROGRAMS))
def test_earlier_objects_decide_whether_later_ones_are_called(title: str) -> None:
    leaves = LEAVES
    for name, mark in zip(("FIRST", "SECOND", "THIRD"), title.partition(": ")[2].split("; "), strict=True):
        leaves = leaves.replace(name, mark)
    assert differing_topics(HEAD + leaves + sections(PROGRAMS)[title] + TAIL) == {}
