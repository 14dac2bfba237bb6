"""Mappings whose keys are classes, such as the listeners of a bus of typed events."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# Programs, each below its title.
PROGRAMS = """\
### listeners of a type of events
from typing import NamedTuple
from collections import defaultdict
class Weighed(NamedTuple):
    kg: float
class Pressed(NamedTuple):
    button: str
class Bus:
    def __init__(self):
        self.listeners = defaultdict(list)
    def on(self, kind, listener):
        self.listeners[kind].append(listener)
    def post(self, event):
        for listener in self.listeners[type(event)]:
            listener(event)
bus = Bus()
def show(event):
    out.publish(event.kg)  # data
def pressed(event):
    out.publish(2.0)  # control
bus.on(Weighed, show)
bus.on(Pressed, pressed)
rospy.Subscriber("in", Float64, lambda m: bus.post(Weighed(m.data)))
def on_joy(m):
    if m.data > 1.0:
        bus.post(Pressed("a"))
rospy.Subscriber("joy", Float64, on_joy)
### a table of functions by class
class A:
    def __init__(self, v): self.v = v
class B(A): pass
def near(o): out.publish(o.v)  # data
def far(o): out.publish(1.0)  # clean
HANDLERS = {A: near, B: far}
def on(msg):
    HANDLERS[A](A(msg.data))
rospy.Subscriber("in", Float64, on)
def other(msg):
    if msg.data > 1.0:
        HANDLERS.get(type(A(1.0)))(A(2.0))
rospy.Subscriber("zzz", Float64, lambda m: None)
### lists that setdefault makes
class A: pass
class B: pass
table = {}
def near(v): out.publish(v)  # data
def far(v): out.publish(v)  # clean
table.setdefault(A, []).append(near)
table.setdefault(B, []).append(far)
def on(msg):
    for f in table.get(A, ()):
        f(msg.data)
rospy.Subscriber("in", Float64, on)
### classes that are the keys of a registry
class A:
    def run(self, v): out.publish(v)  # data
class B:
    def run(self, v): out.publish(v)  # data
table = {A: 1.0, B: 2.0}
def on(msg):
    for cls, factor in table.items():
        cls().run(msg.data * factor)
rospy.Subscriber("in", Float64, on)
### a key that may be any class
class A: pass
class B: pass
table = {A: 0.0, B: 0.0}
def on(msg):
    table[A] = msg.data
    table[type(msg)] = 1.0
    out.publish(table[B])  # clean
    out.publish(table[A])  # data
rospy.Subscriber("in", Float64, on)
### a list for each topic
listeners = {}
def on(topic, function):
    listeners.setdefault(topic, []).append(function)
on("near", lambda value: out.publish(value))  # data
on("far", lambda value: out.publish(value))  # clean
rospy.Subscriber("in", Float64, lambda msg: [one(msg.data) for one in listeners["near"]])
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_classes_can_be_keys_of_a_table(title):
    assert differing(HEAD + CASES[title]) == {}
