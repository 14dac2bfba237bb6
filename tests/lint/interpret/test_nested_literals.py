"""Functions that build objects from nested literals, and call themselves for each part."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Step:
    def __init__(self, function):
        self.function = function
    def tick(self, kiln):
        return self.function(kiln)
class Every:
    def __init__(self, *parts):
        self.parts = parts
    def tick(self, kiln):
        for part in self.parts:
            status = part.tick(kiln)
            if status != 1:
                return status
        return 1
class First:
    def __init__(self, *parts):
        self.parts = parts
    def tick(self, kiln):
        for part in self.parts:
            status = part.tick(kiln)
            if status != 0:
                return status
        return 0
def open_door(kiln):
    return kiln.door == 1.0
def halt(kiln):
    out.publish(0.0)  # door:control
    return 2
def hot(kiln):
    return kiln.heat > 900.0
def cool(kiln):
    out.publish(1.0)  # door:control heat:control
    return 2
def fire(kiln):
    out.publish(2.0)  # door:control heat:control
    return 2
STEPS = {"open": open_door, "halt": halt, "hot": hot, "cool": cool, "fire": fire}
KINDS = {"every": Every, "first": First}
class Kiln:
    def __init__(self):
        self.door = self.heat = 0.0
        self.plan = make(PLAN)
        rospy.Subscriber("door", Float64, self.on_door)
        rospy.Subscriber("heat", Float64, self.on_heat)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def on_door(self, msg):
        self.door = msg.data
    def on_heat(self, msg):
        self.heat = msg.data
    def tick(self, event):
        self.plan.tick(self)
"""
MAKERS = """\
### by a generator
PLAN = ("first", ("every", "open", "halt"), ("every", "hot", "cool"), "fire")
def make(spec):
    if isinstance(spec, str):
        return Step(STEPS[spec])
    kind, *parts = spec
    return KINDS[kind](*(make(part) for part in parts))
Kiln()
### by a list
PLAN = ["first", ["every", "open", "halt"], ["every", "hot", "cool"], "fire"]
def make(spec):
    if not isinstance(spec, str):
        return KINDS[spec[0]](*[make(part) for part in spec[1:]])
    return Step(STEPS[spec])
Kiln()
### one level deeper
PLAN = ("first", ("first", ("every", "open", "halt"), ("every", "hot", "cool")), "fire")
def make(spec):
    if isinstance(spec, str):
        return Step(STEPS[spec])
    kind, *parts = spec
    return KINDS[kind](*(make(part) for part in parts))
Kiln()
"""
TEXTS = """\
### a text or a list from the launch
given = rospy.get_param("~topics", ["left", "right"])
def scan(msg):
    if isinstance(given, str):
        out.publish(msg.data)  # scan:data
    else:
        out.publish(msg.data)  # scan:data
rospy.Subscriber("scan", Float64, scan)
### a list, and a text
names, name = ["left", "right"], "left"
def scan(msg):
    if isinstance(names, str):
        out.publish(msg.data)  # clean
    if isinstance(name, str):
        out.publish(msg.data)  # scan:data
    if isinstance(msg.data, str):
        out.publish(msg.data)  # scan:data
rospy.Subscriber("scan", Float64, scan)
### a literal or something unknown
import json
def load(path):
    return json.load(open(path)) if path else ["left"]
def scan(msg):
    if isinstance(load(rospy.get_param("~path")), str):
        out.publish(msg.data)  # scan:data
rospy.Subscriber("scan", Float64, scan)
### a function that calls itself without a literal
def scan(msg):
    out.publish(total([msg.x, msg.y, msg.z]))  # scan:data
def total(values):
    return values[0] + total(values[1:]) if values else 0.0
rospy.Subscriber("scan", Float64, scan)
"""
CASES, OTHERS = sections(MAKERS), sections(TEXTS)


@pytest.mark.parametrize("name", CASES)
def test_parts_of_nested_literals_are_told_apart(name: str) -> None:
    assert differing_topics(HEAD + CASES[name]) == {}


@pytest.mark.parametrize("name", OTHERS)
def test_queries_for_texts(name: str) -> None:
    assert differing_topics(HEAD.partition("class")[0] + OTHERS[name]) == {}
