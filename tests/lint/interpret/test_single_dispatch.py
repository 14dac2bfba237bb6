"""Functions with `singledispatch`: the type of a message or object chooses the implementation."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import functools, rospy
from functools import singledispatch, singledispatchmethod
from std_msgs.msg import Bool, Float64, String
out = rospy.Publisher("out", Float64, queue_size=1)
last = {"x": 0.0, "y": 0.0}
"""
PROGRAMS = """\
### messages by annotation
@singledispatch
def keep(msg):
    raise TypeError(msg)
@keep.register
def _(msg: Float64):
    last["x"] = msg.data
    out.publish(last["x"])  # a:data
@keep.register
def _(msg: String):
    last["y"] = msg.data
    out.publish(last["y"])  # b:data
rospy.Subscriber("a", Float64, keep)
rospy.Subscriber("b", String, keep)
### a method
class Node:
    def __init__(self):
        self.x = 0.0
        rospy.Subscriber("a", Float64, self.keep)
        rospy.Subscriber("b", String, self.keep)
    @singledispatchmethod
    def keep(self, msg):
        out.publish(msg.data)  # clean
    @keep.register
    def _(self, msg: Float64):
        self.x = msg.data
        out.publish(self.x)  # a:data
    @keep.register
    def _(self, msg: String):
        out.publish(msg.data)  # b:data
Node()
### types as arguments of the decorator, and a general implementation
@functools.singledispatch
def keep(msg):
    out.publish(msg.data)  # c:data
@keep.register(Float64)
def _of_number(msg):
    out.publish(msg.data)  # a:data
@keep.register(String)
def _of_text(msg):
    out.publish(len(msg.data))  # b:data
for name, kind in (("a", Float64), ("b", String), ("c", Bool)):
    rospy.Subscriber(name, kind, keep)
### a union of types
@singledispatch
def keep(msg):
    out.publish(1.0)  # clean
@keep.register
def _(msg: Float64 | Bool):
    out.publish(msg.data)  # a:data c:data
rospy.Subscriber("a", Float64, keep)
rospy.Subscriber("c", Bool, keep)
### instances of classes of the file, and of a class that inherits from one
class Move:
    def __init__(self, speed):
        self.speed = speed
class Fast(Move):
    pass
class Stop:
    pass
@singledispatch
def run(command):
    out.publish(1.0)  # clean
@run.register
def _(command: Move):
    out.publish(command.speed)  # a:data b:data
@run.register
def _(command: Stop):
    out.publish(0.0)  # clean
rospy.Subscriber("a", Float64, lambda msg: run(Move(msg.data)))
rospy.Subscriber("b", Float64, lambda msg: run(Fast(msg.data)))
rospy.Subscriber("c", Bool, lambda msg: run(Stop()))
### data may have any type
@singledispatch
def show(value):
    out.publish(value)  # a:data
@show.register
def _(value: str):
    out.publish(len(value))  # a:data
rospy.Subscriber("a", Float64, lambda msg: show(msg.data))
### one of two messages
@singledispatch
def show(msg):
    return 0.0
@show.register
def _(msg: Float64):
    return msg.data
kept = {}
def step(event):
    out.publish(show(kept["x"]))  # a:data
rospy.Subscriber("a", Float64, lambda msg: kept.update(x=msg))
rospy.Subscriber("b", String, lambda msg: kept.update(y=msg))
rospy.Timer(1.0, step)
### functions in a table are not chosen by type
def near(msg: Float64):
    out.publish(msg.data)  # a:data b:data
def far(msg: String):
    out.publish(msg.data)  # a:data b:data
def on(msg, number=0):
    for one in [near, far]:
        one(msg)
rospy.Subscriber("a", Float64, on)
rospy.Subscriber("b", String, on)
"""


@pytest.mark.parametrize("program", sections(PROGRAMS).values(), ids=sections(PROGRAMS))
def test_the_type_of_the_argument_chooses_the_implementation(program: str) -> None:
    assert differing_topics(HEAD + program) == {}
