"""A comparison or an index decides which element is removed: what is left depends on it, but has no data of it."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback, sections

# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### by value from a list
m = [1.0, 2.0]
m.remove(msg.data)
out.publish(len(m))  # clean
out.publish(m[0])  # control
out.publish(m)  # control
for one in m:
    out.publish(one)  # control
    out.publish(3.0)  # clean
### a loop over known names
m = ["a", "b"]
m.remove(msg.name)
for one in m:
    out.publish(one)  # control
    if one == "a":
        out.publish(1.0)  # control
out.publish(" ".join(m))  # control
out.publish("a" in m)  # control
### a loop over numbered names
m = ["a", "b"]
m.remove(msg.name)
for number, one in enumerate(m):
    out.publish(one)  # control
k = ["a"]
if msg.data > 0.0:
    k.append("b")
for number, one in enumerate(k):
    out.publish(one)  # control
for one, two in zip(k, m):
    out.publish(two)  # control
### if it is there
m = [1.0, 2.0]
if msg.data in m:
    m.remove(msg.data)
out.publish(m)  # control
out.publish(len(m))  # control
### a missing element
m = [1.0, 2.0]
try:
    m.remove(msg.data)
except ValueError:
    out.publish(3.0)  # control
### from a set
s = {1.0, 2.0}
s.discard(msg.data)
out.publish(len(s))  # control
out.publish(1.0 in s)  # control
out.publish(sorted(s))  # control
for one in s:
    out.publish(one)  # control
if s:
    out.publish(1.0)  # control
### elements of another set
s, t = {1.0, 2.0}, {1.0, 2.0}
out.publish(s - {msg.data})  # control
out.publish(len(s - {msg.data}))  # control
out.publish(s - {1.0})  # clean
s -= {msg.data}
out.publish(s)  # control
t.difference_update(msg.items)
out.publish(t)  # control
out.publish(len(t))  # control
u = {msg.data, 2.0}
u.intersection_update({1.0})
out.publish(u)  # data
### by key
d = {"a": 1.0, "b": 2.0}
out.publish(d.pop(msg.name))  # data
out.publish(d.get("a"))  # control
out.publish(d)  # control
out.publish("a" in d)  # control
out.publish(len(d))  # clean
for key in d:
    out.publish(key)  # control
for key, value in d.items():
    out.publish(value)  # control
### by a key that may be missing
d = {"a": 1.0}
d.pop(msg.name, None)
out.publish(len(d))  # control
out.publish(d.get("a"))  # control
### del by key and by slice
d = {"a": 1.0}
del d[msg.name]
out.publish(d.get("a"))  # control
for key in d:
    out.publish(key)  # control
m = [1.0, 2.0, 3.0]
del m[msg.count:]
out.publish(m)  # control
out.publish(len(m))  # control
### by index
m = [1.0, 2.0, 3.0]
m.pop(msg.count)
out.publish(m[0])  # control
### under a condition in an expression
m = [1.0, 2.0]
msg.flag and m.pop()
out.publish(m)  # control
out.publish(len(m))  # control
### elements with data of their own
m = [msg.data, 2.0]
m.remove(2.0)
out.publish(m)  # data
### objects without equality are removed whatever they contain
class Thing:
    def __init__(self, x):
        self.x = x
one, two = Thing(msg.data), Thing(2.0)
m = [one, two]
m.remove(one)
for each in m:
    out.publish(1.0)  # clean
out.publish(m[0].x)  # data
s = {two}
s.discard(one)
out.publish(len(s))  # clean
out.publish(max(thing.x for thing in s))  # clean
### objects with equality
class Thing:
    def __init__(self, x, y):
        self.x, self.y = x, y
    def __eq__(self, other):
        return self.x == other.x
m = [Thing(2.0, 1.0), Thing(3.0, 1.0)]
m.remove(Thing(msg.data, 1.0))
out.publish(m[0].x)  # control
k = [Thing(2.0, 1.0), Thing(3.0, 1.0)]
k.remove(Thing(2.0, msg.data))
out.publish(k[0].x)  # clean
### dataclasses
from dataclasses import dataclass, field
@dataclass
class Thing:
    x: float
    y: float = field(default=0.0, compare=False)
m = [Thing(2.0), Thing(3.0)]
m.remove(Thing(msg.data))
out.publish(m[0].x)  # control
k = [Thing(2.0), Thing(3.0)]
k.remove(Thing(2.0, msg.data))
out.publish(k[0].x)  # clean
### dataclasses that are compared by identity
from dataclasses import dataclass
@dataclass(eq=False)
class Thing:
    x: float
one = Thing(msg.data)
m = [one, Thing(3.0), Thing(4.0)]
m.remove(one)
for each in m:
    out.publish(1.0)  # clean
"""
CASES = sections(PROGRAMS)

SHARED = """
import rospy
from std_msgs.msg import Float64, String

class Node:
    def __init__(self):
        self.names = ["left", "right"]
        self.out = rospy.Publisher("out", String, queue_size=1)
        rospy.Subscriber("in", String, self.receive)
        rospy.Timer(rospy.Duration(1.0), self.tell)

    def receive(self, msg):
        self.names.{removal}

    def tell(self, event):
        for one in self.names:
            self.out.publish(one)  # control
        for number, one in enumerate(self.names):
            self.out.publish("%d %s" % (number, one))  # control
        for one in [name for name in self.names]:
            self.out.publish(one + "!")  # control
        self.out.publish(self.names[0])  # control

Node()
rospy.spin()
"""


@pytest.mark.parametrize("title", CASES)
def test_removal_decides_what_is_left(title):
    assert differing(in_callback(CASES[title])) == {}


@pytest.mark.parametrize("removal", ["remove(msg.data)", "pop(int(msg.data))"])
def test_other_callbacks_depend_on_a_removal_from_a_list_of_known_names(removal):
    assert differing(SHARED.format(removal=removal)) == {}
