"""`isinstance`, `callable`, `hasattr`, and properties that are seen through their class."""

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
### the functions of a property seen through its class
class S:
    def __init__(self):
        self._t = 0.0
        rospy.Subscriber("in", Float64, lambda m: S.target.fset(self, m.data))
    @property
    def target(self):
        return self._t
    @target.setter
    def target(self, v):
        self._t = v
    def step(self, ev):
        out.publish(S.target.fget(self))  # data
s = S()
rospy.Timer(1, s.step)
### the setter of a base class through super
class B:
    _t = 0.0
    @property
    def target(self):
        return self._t
    @target.setter
    def target(self, v):
        self._t = v
class S(B):
    def __init__(self):
        rospy.Subscriber("in", Float64, self.on)
    def on(self, m):
        self.target = m.data
    @property
    def target(self):
        return B.target.fget(self)
    @target.setter
    def target(self, v):
        super(S, type(self)).target.fset(self, v)
    def step(self, ev):
        out.publish(self.target)  # data
s = S()
rospy.Timer(1, s.step)
### a property as descriptor
class B:
    _t = 0.0
    @property
    def target(self):
        return self._t
    @target.setter
    def target(self, v):
        self._t = v
class S(B):
    def __init__(self):
        rospy.Subscriber("in", Float64, self.on)
    def on(self, m):
        B.target.__set__(self, m.data)
    def step(self, ev):
        out.publish(B.target.__get__(self))  # data
s = S()
rospy.Timer(1, s.step)
### marked methods among all attributes
class Pad:
    def __init__(self):
        self.joints = {}
        self.table = []
        self.v = 0.0
        for name in dir(self):
            fn = getattr(self, name)
            if callable(fn) and hasattr(fn, "_mark"):
                self.table.append((fn._mark, fn))
        rospy.Subscriber("other", Float64, self.on_joints)
        rospy.Subscriber("in", Float64, self.on)
    def on_joints(self, msg):
        self.joints[msg.name] = msg.data
    def drive(self, v):
        out.publish(v)  # data
    drive._mark = "axis"
    def other(self, v):
        out.publish(2.0)  # control
    other._mark = "button"
    def on(self, msg):
        for kind, fn in self.table:
            if kind == "axis":
                fn(msg.data)
            elif msg.data > 1.0:
                fn(0.0)
    def step(self, ev):
        if len(self.joints) > 2:
            self.joints.clear()
Pad()
### instances of classes of the files
class Event: pass
class A(Event):
    def __init__(self, v): self.v = v
class B(Event):
    def __init__(self, v): self.v = v
def handle(event):
    if isinstance(event, A):
        out.publish(event.v)  # data
    elif isinstance(event, (B,)):
        out.publish(1.0)  # clean
    if not isinstance(event, Event):
        out.publish(event.v)  # clean
rospy.Subscriber("in", Float64, lambda m: handle(A(m.data)))
def other(m):
    if m.data > 0.0:
        handle(B(2.0))
rospy.Timer(1, other)
### a getter of a property that is read by getattr
class Arm:
    def __init__(self):
        self._pose = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        type(self).pose.__set__(self, msg.data)
    @property
    def pose(self):
        return self._pose
    @pose.setter
    def pose(self, value):
        self._pose = value
arm = Arm()
rospy.Timer(1, lambda event: out.publish(getattr(Arm, "pose").fget(arm)))  # data
### what is not callable
class Callable:
    def __call__(self, value):
        out.publish(value)  # data
class Plain:
    pass
kept = {}
def on(msg):
    for one in (Callable(), Plain(), kept, 2.0, [msg.data]):
        if callable(one):
            one(msg.data)
    one = Callable()
    if callable(one) and isinstance(one, Plain):
        out.publish(msg.data)  # clean
    if callable(kept) or callable(msg):
        out.publish(msg.data)  # clean
rospy.Subscriber("in", Float64, on)
### functions that may have an attribute
def near(value):
    out.publish(value)  # data
near.marked = True
def far(value):
    out.publish(value)  # clean
def call(function, value):
    if hasattr(function, "marked"):
        function(value)
def on(msg):
    call(near, msg.data)
    call(far, msg.data)
rospy.Subscriber("in", Float64, on)
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_the_type_of_an_object_decides_which_branch_runs(title):
    assert differing(HEAD + CASES[title]) == {}
