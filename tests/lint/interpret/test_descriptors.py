"""Descriptors that keep what they make in the `__dict__` of the object, and its entries."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import rospy, types
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
BODIES = """\
### a publisher that is made when it is first read
class Port:
    def __init__(self, topic):
        self.topic = topic
    def __get__(self, owner, kind=None):
        if owner is None:
            return self
        ports = owner.__dict__.setdefault("_ports", {})
        if self.topic not in ports:
            ports[self.topic] = rospy.Publisher(self.topic, Float64, queue_size=1)
        return ports[self.topic]
class Oven:
    heat = Port("heat")
    fan = Port("fan")
    def __init__(self):
        rospy.Subscriber("scan", Float64, self.on_scan)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def on_scan(self, msg):
        if msg.data > 3.0:
            self.heat.publish(1.0)  # scan:control
        self.fan.publish(msg.data)  # scan:data
    def tick(self, event):
        self.heat.publish(0.0)  # clean
        self.fan.publish(0.0)  # clean
Oven()
### entries of a `__dict__` by `setdefault`
class Valve:
    def __init__(self):
        self.slots = {}
        vars(self).setdefault("closed", {})
valve = Valve()
def scan(msg):
    valve.__dict__.setdefault("last", msg.data)
    out.publish(valve.last)  # scan:data
    out.publish(valve.__dict__["last"])  # scan:data
    out.publish(valve.__dict__.get("last"))  # scan:data
    out.publish(valve.__dict__.get("first", 0.0))  # clean
    out.publish(valve.__dict__.setdefault("second", 0.0))  # clean
    valve.__dict__["closed"]["x"] = msg.data
    out.publish(valve.closed["x"])  # scan:data
    out.publish(valve.slots)  # clean
rospy.Subscriber("scan", Float64, scan)
### entries of a namespace by `setdefault`
space = types.SimpleNamespace(unit=1)
def scan(msg):
    made = vars(space).setdefault("made", {})
    made["x"] = msg.data
    out.publish(space.made["x"])  # scan:data
    out.publish(space.unit)  # clean
rospy.Subscriber("scan", Float64, scan)
### a descriptor whose values take its place in the object
class Lazy:
    def __init__(self, make):
        self.make = make
    def __set_name__(self, owner, name):
        self.name = name
    def __get__(self, obj, cls=None):
        if obj is None:
            return self
        kept = vars(obj)
        if self.name not in kept:
            kept[self.name] = self.make(obj)
        return kept[self.name]
class Arm:
    reach = Lazy(lambda self: self.length * 2.0)
    elbow = Lazy(lambda self: 3.0)
    out = Lazy(lambda self: rospy.Publisher("reach", Float64, queue_size=1))
    def __init__(self):
        self.length = 0.0
        rospy.Subscriber("scan", Float64, self.on_scan)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def on_scan(self, msg):
        self.length = msg.data
        self.__dict__.pop("reach", None)
    def tick(self, event):
        if self.reach > 1.0:
            self.out.publish(2.0)  # scan:control
        self.out.publish(self.elbow)  # clean
        self.out.publish(self.reach)  # scan:data
Arm()
### a descriptor that ignores values of the class itself
class Checked:
    def __set_name__(self, owner, name):
        self.name = name
    def __set__(self, obj, value):
        if obj is None:
            return
        obj.__dict__[self.name] = value
    def __get__(self, obj, owner=None):
        return self if obj is None else obj.__dict__[self.name]
class Boom:
    angle = Checked()
    speed = Checked()
    def __init__(self):
        self.angle = 0.0
        self.speed = 1.0
        rospy.Subscriber("scan", Float64, self.on_scan)
    def on_scan(self, msg):
        self.angle = msg.data
        out.publish(self.angle)  # scan:data
        out.publish(self.speed)  # clean
Boom()
### names of attributes in a `__dict__`
class Store:
    def __init__(self):
        self.value = 0.0
store = Store()
def scan(msg):
    store.value = msg.data
    if msg.data > 1.0:
        store.high = True
    if "value" in store.__dict__:
        out.publish(1.0)  # clean
    if "high" in vars(store):
        out.publish(1.0)  # scan:control
    if msg.header.frame_id in vars(store):
        out.publish(1.0)  # scan:control
rospy.Subscriber("scan", Float64, scan)
### a class that answers `in` by its elements
class Box:
    def __init__(self):
        self.items = []
    def __iter__(self):
        return iter(self.items)
box = Box()
def scan(msg):
    box.items.append(msg.data)
    out.publish(1.0 in box)  # scan:data
rospy.Subscriber("scan", Float64, scan)
"""
CASES = sections(BODIES)


@pytest.mark.parametrize("name", CASES)
def test_descriptors(name: str) -> None:
    assert differing_topics(HEAD + CASES[name]) == {}
