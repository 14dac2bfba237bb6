"""Idioms of classes: `__getattr__`, `property(…)`, `type(x)`, managers on an `ExitStack`, and lazy containers."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import collections, contextlib, dataclasses, itertools, rospy
from std_msgs.msg import Float64, String
out = rospy.Publisher("out", Float64, queue_size=1)
"""
BODIES = """\
### a wrapper that passes all method calls on
class Base:
    def __init__(self):
        self.scale = 1.0
    def drive(self, x, y):
        out.publish(self.scale * x)  # scan:data pose:data
        out.publish(y)  # clean
class Logged:
    def __init__(self, inner):
        self.inner = inner
    def __getattr__(self, name):
        attribute = getattr(self.inner, name)
        if not callable(attribute):
            return attribute
        def call(*args, **kwargs):
            rospy.logdebug(name)
            return attribute(*args, **kwargs)
        return call
base = Base()
robot = Logged(base)
def scan(msg):
    robot.drive(msg.data, y=1.0)
def pose(msg):
    base.scale = msg.data
### a wrapper that returns the methods of another object
class Base:
    def drive(self, x):
        out.publish(x)  # scan:data
class Wrapper:
    def __init__(self, inner):
        self.inner = inner
    def __getattr__(self, name):
        return getattr(self.inner, name)
    def own(self, x):
        out.publish(x)  # clean
robot = Wrapper(Base())
def scan(msg):
    robot.drive(msg.data)
    robot.own(1.0)
### what only the constructor of a dataclass gets
@dataclasses.dataclass
class Pose:
    x: float
    degrees: dataclasses.InitVar[float] = 0.0
    yaw: float = dataclasses.field(init=False)
    def __post_init__(self, degrees):
        self.yaw = 3.14 * degrees
def scan(msg):
    out.publish(Pose(msg.data, 1.0).yaw)  # clean
    out.publish(Pose(1.0, msg.data).yaw)  # scan:data
    out.publish(Pose(1.0, msg.data).x)  # clean
### parameters that get the fields with `InitVar` in their order, under other names
@dataclasses.dataclass
class Pose:
    low: dataclasses.InitVar[float]
    x: float
    high: dataclasses.InitVar[float] = 0.0
    def __post_init__(self, least, most):
        self.least, self.most = least, most
def scan(msg):
    out.publish(Pose(msg.data, 1.0, 2.0).least)  # scan:data
    out.publish(Pose(msg.data, 1.0, 2.0).most)  # clean
    out.publish(Pose(1.0, 2.0, high=msg.data).most)  # scan:data
    out.publish(Pose(1.0, 2.0, msg.data).high)  # clean
    out.publish(Pose(1.0, msg.data).most)  # clean
### attributes of an object with `__getattr__`, stored as entries of its `__dict__`
class Latest:
    def __init__(self):
        self.__dict__.update(count=0, message=None)
        vars(self).update(other=0)
    def __getattr__(self, name):
        return getattr(self.message, name)
latest = Latest()
def scan(msg):
    latest.message = msg
    latest.count += 1
    latest.other += 1
    out.publish(latest.count)  # clean
    out.publish(latest.other)  # clean
    out.publish(latest.data)  # scan:data
### properties made by a call
class Motor:
    def __init__(self):
        self.limited, self.plain = 0.0, 0.0
    def get(self):
        return self.limited
    def set(self, value):
        self.limited = min(value, 1.0)
    speed = property(get, set)
    other = property(fget=lambda self: self.plain)
    nothing = property()
def scan(msg):
    motor, second = Motor(), Motor()
    motor.speed, second.speed, second.plain = msg.data, 1.0, msg.data
    out.publish(motor.limited)  # scan:data
    out.publish(motor.speed)  # scan:data
    out.publish(motor.other)  # clean
    out.publish(motor.nothing)  # clean
    out.publish(second.speed)  # clean
    out.publish(second.other)  # scan:data
### the class of a chosen object
class Idle:
    pass
class Running:
    pass
def scan(msg):
    state = Idle() if msg.data > 1.0 else Running()
    if type(state) is Idle:
        out.publish(1.0)  # scan:control
    if type(msg.data) is float:
        out.publish(2.0)  # clean
    if type(Idle()) is Idle:
        out.publish(3.0)  # clean
    out.publish(type(state).__name__)  # scan:control
### managers on a stack
class Keeper:
    def __init__(self):
        self.value = 0.0
    def __enter__(self):
        return self
    def __exit__(self, *exc):
        out.publish(self.value)  # scan:data
def scan(msg):
    with contextlib.ExitStack() as stack:
        keeper = stack.enter_context(Keeper())
        keeper.value = msg.data
### keys that a default dictionary adds
added, fixed = collections.defaultdict(list), collections.defaultdict(list)
def scan(msg):
    added[msg.data].append(1.0)
    fixed["a"].append(msg.data)
def pose(msg):
    out.publish(len(added))  # scan:data
    out.publish(len(fixed))  # clean
### elements that a predicate selects
def scan(msg):
    for select in (itertools.takewhile, itertools.dropwhile, itertools.filterfalse):
        out.publish(list(select(lambda x: x < msg.data, [1.0, 2.0]))[0])  # scan:control
        out.publish(list(select(lambda x: x < 1.0, [msg.data, 2.0]))[0])  # scan:data
    out.publish(list(itertools.takewhile(lambda x: x < 1.0, [1.0, 2.0]))[0])  # clean
### elements that other elements select
def scan(msg):
    out.publish(list(itertools.compress([1.0, 2.0], [msg.data, 1.0]))[0])  # scan:control
    out.publish(list(itertools.compress([msg.data, 2.0], [1.0, 1.0]))[0])  # scan:data
    out.publish(list(itertools.compress([1.0, 2.0], [1.0, 1.0]))[0])  # clean
### a function applied to tuples
def scan(msg):
    rows = [(1.0, msg.data), (2.0, msg.data)]
    out.publish(list(itertools.starmap(lambda x, y: x, rows))[0])  # clean
    out.publish(list(itertools.starmap(lambda x, y: y, rows))[0])  # scan:data
    out.publish(list(itertools.starmap(lambda x, y: y, library(msg)))[0])  # scan:data
"""


@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_an_idiom_has_the_marked_flows(body):
    pose = "" if "def pose" in body else "def pose(msg):\n    pass\n"
    ends = 'rospy.Subscriber("scan", Float64, scan)\nrospy.Subscriber("pose", Float64, pose)\nrospy.spin()\n'
    assert differing_topics(f"{HEAD}{body}{pose}{ends}") == {}
