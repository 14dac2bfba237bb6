"""Metaclasses of the files, which run for each class that they make."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import abc, rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
TAIL = """
class Base(metaclass=Meta):
    topic = ""
    def __init__(self):
        rospy.Subscriber(self.topic, Float64, self.on)
    def on(self, msg):
        out.publish(self.change(msg.data))  # a:data b:data
class Same(Base):
    topic = "a"
    def change(self, number):
        return number
class Twice(Base):
    topic = "b"
    def change(self, number):
        return 2 * number
class Later(Same):
    topic = "b"
for cls in Meta.known:
    cls()
"""
META = """\
### __new__ appends to a list
class Meta(type):
    known = []
    def __new__(mcs, name, bases, body):
        cls = super().__new__(mcs, name, bases, body)
        if bases:
            mcs.known.append(cls)
        return cls
### type.__new__
class Meta(type):
    known = []
    def __new__(mcs, name, bases, body):
        cls = type.__new__(mcs, name, bases, body)
        if name != "Base":
            Meta.known.append(cls)
        return cls
### __init__ appends to a list
class Meta(type):
    known = []
    def __init__(cls, name, bases, body):
        super().__init__(name, bases, body)
        if bases:
            Meta.known.append(cls)
### a metaclass of abstract classes, with keywords
class Meta(abc.ABCMeta):
    known = []
    def __new__(mcs, name, bases, body, **options):
        cls = super().__new__(mcs, name, bases, body, **options)
        if body.get("topic"):
            mcs.known.append(cls)
        return cls
### a metaclass that inherits from another one
class First(type):
    known = []
    def __new__(mcs, name, bases, body):
        cls = super().__new__(mcs, name, bases, body)
        if bases:
            First.known.append(cls)
        return cls
class Meta(First):
    pass
### a function of a module registers the class
known = []
def register(cls):
    known.append(cls)
class Meta(type):
    known = known
    def __init__(cls, name, bases, body):
        if bases:
            register(cls)
"""
OTHERS = """\
### a metaclass that registers nothing
class Meta(type):
    known = []
class Base(metaclass=Meta):
    def __init__(self):
        rospy.Subscriber("a", Float64, lambda msg: out.publish(msg.data))  # a:data
class Other(metaclass=abc.ABCMeta):
    def go(self):
        out.publish(1.0)  # clean
Base()
for cls in Meta.known:
    out.publish(1.0)  # clean
### a method of the metaclass
class Meta(type):
    def topic(cls):
        return cls.__name__.lower()
class Scan(metaclass=Meta):
    pass
rospy.Subscriber("a", Float64, lambda msg: out.publish(msg.data))  # a:data
### an attribute that the metaclass sets
class Meta(type):
    def __init__(cls, name, bases, body):
        cls.topic = "a/" + name
class Scan(metaclass=Meta):
    pass
rospy.Subscriber(Scan.topic, Float64, lambda msg: out.publish(msg.data))  # a/Scan:data
"""


@pytest.mark.parametrize("meta", sections(META).values(), ids=sections(META))
def test_a_metaclass_registers_classes(meta: str) -> None:
    assert differing_topics(HEAD + meta + TAIL) == {}


@pytest.mark.parametrize("program", sections(OTHERS).values(), ids=sections(OTHERS))
def test_flows_through_other_metaclasses_are_found(program: str) -> None:
    assert differing_topics(HEAD + program) == {}
