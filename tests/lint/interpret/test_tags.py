"""A branch that tests a tag has the data of objects with this tag only, and depends on how they came there."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import queue, rospy
from dataclasses import dataclass
from enum import Enum
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Kind(Enum):
    LOAD = 1
    HEAT = 2
@dataclass
class Load:
    value: float
@dataclass
class Heat:
    value: float
@dataclass
class Event:
    kind: Kind
    value: float
pairs, dicts, things, events = queue.Queue(), queue.Queue(), queue.Queue(), queue.Queue()
def load(msg):
    pairs.put(("load", msg.data))
    dicts.put({"type": "load", "value": msg.data})
    things.put(Load(msg.data))
    events.put(Event(Kind.LOAD, msg.data))
def heat(msg):
    dicts.put({"type": "heat", "value": msg.data})
    if msg.data > 3.0:
        pairs.put(("heat", msg.data))
        things.put(Heat(msg.data))
        events.put(Event(Kind.HEAT, msg.data))
rospy.Subscriber("load", Float64, load)
rospy.Subscriber("heat", Float64, heat)
"""
BODIES = """\
### the first element of a pair
kind, value = pairs.get()
if kind == "load":
    out.publish(value)  # load:data
    out.publish(1.0)  # clean
elif kind == "heat":
    out.publish(value)  # heat:data
    out.publish(1.0)  # heat:control
### an unpacked variable has its former value after the branches
kind, value = pairs.get()
if kind == "load":
    pass
out.publish(value)  # load:data heat:data
if kind != "load":
    out.publish(value)  # heat:data
if kind in ("heat", "cold"):
    out.publish(value)  # heat:data
if kind == "load" or kind == "cold":
    out.publish(value)  # load:data
if not (kind == "load"):
    out.publish(value)  # heat:data
### an assignment in a branch stays
kind, value = pairs.get()
if kind == "load":
    value = 0.0
out.publish(value)  # heat:data
### a branch that leaves narrows what follows
kind, value = pairs.get()
if kind == "load":
    return
out.publish(value)  # heat:data
### an element by its index
pair = pairs.get()
if pair[0] == "heat":
    out.publish(pair[1])  # heat:data
else:
    out.publish(pair[1])  # load:data
tag = pair[0]
if tag == "heat":
    out.publish(pair[1])  # heat:data
### an entry of a mapping
entry = dicts.get()
if entry["type"] == "heat":
    out.publish(entry["value"])  # heat:data
if entry.get("type") == "load":
    out.publish(entry["value"])  # load:data
### the class of an object
one = things.get()
if isinstance(one, Load):
    out.publish(one.value)  # load:data
    out.publish(1.0)  # clean
else:
    out.publish(one.value)  # heat:data
    out.publish(1.0)  # heat:control
out.publish(one.value if isinstance(one, Load) else 0.0)  # load:data
if isinstance(one, Heat) and one.value > 4.0:
    out.publish(1.0)  # heat:control
out.publish(one.value)  # load:data heat:data
### a member of an enumeration
event = events.get()
if event.kind is Kind.LOAD:
    out.publish(event.value)  # load:data
elif event.kind is Kind.HEAT:
    out.publish(event.value)  # heat:data
### a constant
def check():
    value = pairs.get()[1]
    return "good" if value > 1.0 else "bad"
def either():
    for answer in (check(), "good"):
        if answer != "bad":
            return answer
    return "bad"
if either() == "good":
    out.publish(1.0)  # clean
answer = check()
if answer == "good":
    out.publish(1.0)  # load:control heat:control
### an implementation for a type
from functools import singledispatch
@singledispatch
def handle(one):
    out.publish(0.0)  # clean
@handle.register
def _(one: Load):
    out.publish(1.0)  # number:control
@handle.register
def _(one: Heat):
    out.publish(2.0)  # number:control
def number(msg):
    handle(Load(1.0) if msg.data > 1.0 else Heat(1.0))
rospy.Subscriber("number", Float64, number)
### a pattern
match dicts.get():
    case {"type": "heat" | "cold", "value": value}:
        out.publish(value)  # heat:data
    case {"type": "load", "value": value}:
        out.publish(value)  # load:data
### a parameter
def handle(pair):
    kind, value = pair
    if kind == "heat":
        out.publish(value)  # heat:data
handle(pairs.get())
### elements of a list
waiting = list(dicts.queue)
out.publish([one["value"] for one in waiting if one["type"] == "heat"][0])  # heat:data
out.publish([value for kind, value in list(pairs.queue) if kind == "heat"][0])  # heat:data
### an unknown tag may be any object
kind, value = pairs.get()
if kind == value:
    out.publish(1.0)  # load:control heat:control
if kind == input():
    out.publish(value)  # load:data heat:data
### a tag that no object has
kind, value = pairs.get()
if kind == "stop":
    out.publish(value)  # clean
### arguments that are elements
def handle(kind, value):
    if kind == "load":
        out.publish(value)  # load:data
    elif kind == "heat":
        out.publish(value)  # heat:data
        out.publish(1.0)  # heat:control
kind, value = pairs.get()
handle(kind, value)
### an unpacked argument
def handle(kind, value):
    if kind == "load":
        out.publish(value)  # load:data
        out.publish(1.0)  # clean
    else:
        out.publish(value)  # heat:data
handle(*pairs.get())
### an unpacked argument behind another one, of a method that passes it on
class Worker:
    def handle(self, unit, kind, value):
        self.work(value, kind=kind)
    def work(self, value, kind):
        if kind == "load":
            out.publish(value)  # load:data
        else:
            out.publish(value)  # heat:data
pair = pairs.get()
Worker().handle("mm", *pair)
### an unpacked mapping
def handle(value, type="load"):
    if type == "heat":
        out.publish(value)  # heat:data
handle(**dicts.get())
### arguments that are attributes and entries
def handle(kind, value):
    if kind == Kind.LOAD:
        out.publish(value)  # load:data
def treat(entry, value, kind):
    if kind == "heat":
        out.publish(value)  # heat:data
        out.publish(entry["value"])  # heat:data
event, entry = events.get(), dicts.get()
handle(event.kind, event.value)
treat(entry, entry["value"], entry.get("type"))
### arguments of two objects
def handle(kind, value):
    if kind == "heat":
        out.publish(value)  # load:data heat:data
handle(dicts.get()["type"], dicts.get()["value"])
first, second = pairs.get(), pairs.get()
handle(first[0], second[1])
### an attribute that is read before the test
event = events.get()
value = event.value
if event.kind == Kind.HEAT:
    out.publish(value)  # heat:data
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_branch_on_an_object_kind_sees_only_that_kind(title: str) -> None:
    body = sections(BODIES)[title].replace("\n", "\n    ")
    assert not differing_topics(f"{HEAD}def step(event):\n    {body}\nrospy.Timer(1.0, step)\nrospy.spin()\n")
