"""`*rest` in targets, parameters and patterns keeps the elements apart; so do class patterns without names."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import queue, rospy
from dataclasses import dataclass
from std_msgs.msg import Float64, String
out = rospy.Publisher("out", Float64, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
jobs = queue.Queue()
@dataclass
class Base:
    stamp: float
@dataclass
class Go(Base):
    x: float
@dataclass
class Turn(Base):
    angle: float
class Own:
    __match_args__ = ("x", "y")
    def __init__(self, y, x):
        self.x, self.y = x, y
def pose(msg):
    pass
def waiting():
    rospy.Subscriber("scan", Float64, scan)
    rospy.Subscriber("pose", Float64, pose)
    return not rospy.is_shutdown()
"""
BODIES = """\
### rest in targets
def scan(msg):
    first, *rest = [1.0, msg.data, 2.0]
    out.publish(first)  # clean
    out.publish(rest[0])  # scan:data
    out.publish(rest[1])  # clean
    out.publish(rest[-1])  # clean
### rest in the middle
def scan(msg):
    first, *middle, last = (1.0, 2.0, msg.data, 4.0)
    out.publish(first)  # clean
    out.publish(last)  # clean
    out.publish(middle[0])  # clean
    out.publish(middle[1])  # scan:data
### match with rest
def scan(msg):
    match ("set", 1.0, msg.data, 3.0):
        case ["set", a, *rest]:
            out.publish(a)  # clean
            out.publish(rest[0])  # scan:data
            out.publish(rest[1])  # clean
### match with rest in the middle
def scan(msg):
    match ("set", 1.0, msg.data, 3.0):
        case [kind, *rest, c]:
            out.publish(c)  # clean
            out.publish(rest[0])  # clean
            out.publish(rest[1])  # scan:data
### tagged tuples of several lengths
def scan(msg):
    jobs.put(("scan", msg.data, 1.0))
def pose(msg):
    jobs.put(("pose", 1.0, msg.data, msg.data))
while waiting():
    kind, *rest = jobs.get()
    if kind == "scan":
        out.publish(rest[0])  # scan:data
        out.publish(rest[1])  # clean
    elif kind == "pose":
        x, *others = rest
        out.publish(x)  # clean
        out.publish(others[0])  # pose:data
### tags behind a star
def scan(msg):
    jobs.put((1.0, msg.data, "scan"))
def pose(msg):
    jobs.put((msg.data, "pose"))
while waiting():
    first, *_, kind = jobs.get()
    if kind == "scan":
        out.publish(first)  # clean
    *(start, *rest, which), = jobs.get()
    if which == "scan":
        out.publish(start)  # clean
        out.publish(rest)  # scan:data
### tags behind a star in a comprehension
kept = []
def scan(msg):
    kept.append((1.0, msg.data, "scan"))
def pose(msg):
    kept.append((msg.data, "pose"))
while waiting():
    out.publish([first for first, *_, kind in kept if kind == "scan"])  # clean
    out.publish([first for first, *_, kind in kept if kind == "pose"])  # pose:data
### tagged tuples with match
def scan(msg):
    jobs.put(("scan", msg.data, 1.0))
def pose(msg):
    jobs.put(("pose", 1.0, msg.data, msg.data))
while waiting():
    match jobs.get():
        case ("scan", *values):
            out.publish(values[0])  # scan:data
            out.publish(values[1])  # clean
        case ("pose", x, *others):
            out.publish(x)  # clean
            out.publish(others[0])  # pose:data
### a handler with *rest
def scan(msg):
    jobs.put(("scan", msg.data, 1.0))
def pose(msg):
    jobs.put(("pose", 1.0, msg.data))
def handle(kind, *rest):
    if kind == "scan":
        out.publish(rest[0])  # scan:data
        out.publish(rest[1])  # clean
    else:
        out.publish(rest[0])  # clean
        out.publish(rest[1])  # pose:data
while waiting():
    handle(*jobs.get())
### a split text
def scan(msg):
    command, *args = msg.data.split()
    if command == "speed":
        out.publish(float(args[0]))  # scan:data
    elif command == "stop":
        out.publish(0.0)  # scan:control
### loops with rest
def scan(msg):
    for name, *values in [("a", 1.0, 2.0), ("b", msg.data, 3.0)]:
        out.publish(values[1])  # clean
        out.publish(values[0])  # scan:data
### match mapping with rest
def scan(msg):
    match {"kind": "set", "a": 1.0, "b": msg.data}:
        case {"kind": "set", "a": a, **rest}:
            out.publish(a)  # clean
            out.publish(rest["b"])  # scan:data
### a handler with *rest, and tuples of different lengths
def scan(msg):
    jobs.put(("scan", msg.data, 1.0))
def pose(msg):
    jobs.put(("pose", msg.data))
def handle(kind, *rest):
    if kind == "scan":
        out.publish(rest[0])  # scan:data
        out.publish(rest[1])  # clean
    else:
        out.publish(rest[0])  # pose:data
def other(first, last=0.0, *rest):
    out.publish(last)  # scan:data pose:data
    out.publish(rest[0])  # clean
while waiting():
    handle(*jobs.get())
    other(*jobs.get())
### a comprehension with *rest
def scan(msg):
    rows = [("a", 1.0, msg.data), ("b", 2.0, msg.data)]
    out.publish([first for name, first, *rest in rows][0])  # clean
    out.publish([rest for name, first, *rest in rows][0][0])  # scan:data
### the last element of several tuples
def scan(msg):
    jobs.put(("scan", 1.0, msg.data))
def pose(msg):
    jobs.put(("pose", msg.data))
while waiting():
    kind, *rest, last = jobs.get()
    out.publish(last)  # scan:data pose:data
    if kind == "scan":
        out.publish(last)  # scan:data
        out.publish(rest[0])  # clean
### slices of several tuples
def scan(msg):
    jobs.put(("scan", msg.data, 1.0))
def pose(msg):
    jobs.put(("pose", 1.0, msg.data))
while waiting():
    job = jobs.get()
    rest = job[1:]
    out.publish(rest[0])  # scan:data
    out.publish(job[2:][0])  # pose:data
    out.publish(len(rest))  # clean
### fields by position
def scan(msg): jobs.put(Go(1.0, msg.data))
def pose(msg): jobs.put(Turn(msg.data, 1.0))
while waiting():
    match jobs.get():
        case Go(stamp, x):
            out.publish(stamp)  # clean
            out.publish(x)  # scan:data
        case Turn(stamp, angle):
            out.publish(stamp)  # pose:data
            out.publish(angle)  # clean
### fields by name, which both classes have
def scan(msg): jobs.put(Go(msg.data, 1.0))
def pose(msg): jobs.put(Turn(msg.data, 1.0))
while waiting():
    match jobs.get():
        case Go(stamp=s):
            out.publish(s)  # scan:data
        case Turn(stamp=s):
            out.publish(s)  # pose:data
### match args
def scan(msg):
    match Own(1.0, msg.data):
        case Own(x, y):
            out.publish(x)  # scan:data
            out.publish(y)  # clean
### fields that the constructor does not take by position
from dataclasses import field
@dataclass
class Jump:
    early: float = field(init=False, default=0.0)
    stamp: float
    late: float = field(kw_only=True, default=0.0)
    height: float = 0.0
def scan(msg):
    match Jump(1.0, msg.data):
        case Jump(stamp, height):
            out.publish(stamp)  # clean
            out.publish(height)  # scan:data
### fields below KW_ONLY, and of a class with kw_only
from dataclasses import KW_ONLY
@dataclass(kw_only=True)
class Base:
    name: str
@dataclass
class Jump(Base):
    stamp: float
    _: KW_ONLY
    late: float = 0.0
def scan(msg):
    match Jump(1.0, name=msg.data):
        case Jump(stamp):
            out.publish(stamp)  # clean
    match Jump(msg.data, name="a"):
        case Jump(stamp):
            out.publish(stamp)  # scan:data
### a whole number
def scan(msg):
    match msg.data:
        case float(number):
            out.publish(number)  # scan:data
        case str(text):
            out.publish(1.0)  # scan:control
### a class of a library
from geometry_msgs.msg import Point
def scan(msg):
    match Point(msg.data, 1.0):
        case Point(x):
            out.publish(x)  # scan:data
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_each_element_has_the_marked_flows(body):
    assert differing_topics(f"{HEAD}{body}waiting()\n") == {}
