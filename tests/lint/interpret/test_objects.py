"""Objects, classes and messages hold data as in Python."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

HEAD = """\
import asyncio, enum, rospy
from geometry_msgs.msg import Twist, Vector3
"""
# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### a field belongs to one object
class P:
    def __init__(self, x):
        self.x = x
        self.y = 1.0
p, q = P(msg.data), P(1.0)
out.publish(p.x)  # data
out.publish(p.y)  # clean
out.publish(q.x)  # clean
q.y = msg.data
out.publish(q.y)  # data
out.publish(p.y)  # clean
p.x = 1.0
out.publish(p.x)  # clean
### two names of one object
class P:
    pass
p = P()
q = p
q.x = msg.data
out.publish(p.x)  # data
l = [p]
l[0].x = 1.0
out.publish(p.x)  # clean
### one of two objects
class P:
    x = 1.0
p, q = P(), P()
r = p if rospy.get_time() > 1.0 else q
r.x = msg.data
out.publish(p.x)  # data
out.publish(q.x)  # data
r.x = 2.0
out.publish(p.x)  # data
### a default of the class
class P:
    x = 1.0
    l = []
p, q = P(), P()
p.x = msg.data
out.publish(p.x)  # data
out.publish(q.x)  # clean
out.publish(P.x)  # clean
P.x = msg.data
out.publish(q.x)  # data
p.l.append(msg.data)
out.publish(q.l[0])  # data
### methods
class P:
    def set(self, x):
        self.x = x
        return self
    def get(self):
        return self.x
    @staticmethod
    def same(x):
        return x
    @classmethod
    def made(cls, x):
        p = cls()
        p.x = x
        return p
    @property
    def twice(self):
        return 2.0 * self.x
    @twice.setter
    def twice(self, x):
        self.x = x / 2.0
p, q = P(), P()
p.set(msg.data)
q.set(1.0)
out.publish(p.get())  # data
out.publish(q.get())  # clean
out.publish(p.twice)  # data
out.publish(q.twice)  # clean
out.publish(P.same(msg.data))  # data
out.publish(p.same(1.0))  # clean
out.publish(P.made(msg.data).get())  # data
out.publish(P.made(1.0).get())  # clean
out.publish(P.get(p))  # data
out.publish(P().set(msg.data).get())  # data
q.twice = msg.data
out.publish(q.x)  # data
f = p.get
out.publish(f())  # data
g = P.get
out.publish(g(P().set(1.0)))  # clean
### inherited methods
class A:
    def __init__(self):
        self.x = self.first()
    def first(self):
        return 1.0
    def second(self):
        return self.third()
    def third(self):
        return 1.0
class B(A):
    def first(self):
        return msg.data
    def third(self):
        return super().third() + msg.data
class C(B):
    def third(self):
        return super(B, self).third()
out.publish(A().x)  # clean
out.publish(B().x)  # data
out.publish(A().second())  # clean
out.publish(B().second())  # data
out.publish(C().second())  # clean
### several base classes
class A:
    def f(self):
        return 1.0
class B:
    def f(self):
        return msg.data
    def g(self):
        return msg.data
class C(A, B):
    pass
class D(B, A):
    pass
out.publish(C().f())  # clean
out.publish(D().f())  # data
out.publish(C().g())  # data
### special methods
class V:
    def __init__(self, x):
        self.x = x
    def __add__(self, other):
        return V(self.x)
    def __radd__(self, other):
        return V(self.x)
    def __mul__(self, other):
        return V(1.0)
    def __neg__(self):
        return V(self.x)
    def __eq__(self, other):
        return self.x > 1.0
    def __lt__(self, other):
        return True
    def __getitem__(self, key):
        return self.x if key else 1.0
    def __len__(self):
        return self.x
    def __contains__(self, item):
        return self.x
    def __call__(self, y):
        return y
    def __bool__(self):
        return True
    def __iter__(self):
        yield self.x
    def __float__(self):
        return 1.0
    def __getattr__(self, name):
        return self.x
    def __enter__(self):
        return self.x
    def __exit__(self, *error):
        return False
v, w = V(msg.data), V(1.0)
out.publish((v + w).x)  # data
out.publish((w + v).x)  # clean
out.publish((1.0 + v).x)  # data
out.publish((v * 2.0).x)  # clean
out.publish((-v).x)  # data
out.publish(v == w)  # data
out.publish(w == v)  # clean
out.publish(v < w)  # clean
out.publish(v[1])  # data
out.publish(v(1.0))  # clean
out.publish(w(msg.data))  # data
out.publish(1.0 in v)  # data
out.publish(1.0 in w)  # clean
for x in v:
    out.publish(x)  # data
for x in w:
    out.publish(x)  # clean
out.publish(v.other)  # data
out.publish(w.other)  # clean
with v as x:
    out.publish(x)  # data
with w as x:
    out.publish(x)  # clean
### augmented special methods
class V:
    def __init__(self, x):
        self.x = x
    def __iadd__(self, other):
        self.x = other
        return self
v = V(1.0)
v += msg.data
out.publish(v.x)  # data
v += 1.0
out.publish(v.x)  # clean
### objects in a list
class P:
    x = 1.0
l = [P(), P()]
l[0].x = msg.data
out.publish(l[0].x)  # data
out.publish(l[1].x)  # clean
### objects made in a loop
class P:
    pass
l = []
for n in range(3):
    p = P()
    p.x = msg.data
    l.append(p)
out.publish(l[0].x)  # data
### a nested object
class P:
    def __init__(self, inner=None):
        self.inner = inner
        self.x = 1.0
p = P(P(P()))
p.inner.inner.x = msg.data
out.publish(p.inner.inner.x)  # data
out.publish(p.inner.x)  # clean
out.publish(p.x)  # clean
p.inner = P()
out.publish(p.inner.x)  # clean
### a chain of objects
class N:
    def __init__(self, x, after):
        self.x = x
        self.after = after
first = None
for n in range(3):
    first = N(msg.data, first)
out.publish(first.after.after.x)  # data
other = N(1.0, N(2.0, None))
out.publish(other.after.x)  # clean
### an object that contains itself
class N:
    pass
n = N()
n.me = n
n.me.me.x = msg.data
out.publish(n.x)  # data
### messages
t = Twist()
t.linear.x = msg.data
u = Twist()
u.linear = t.linear
out.publish(t.linear.x)  # data
out.publish(t.linear.y)  # clean
out.publish(t.angular)  # clean
out.publish(t)  # data
out.publish(u.linear.x)  # data
out.publish(u.angular.x)  # clean
t.linear.x = 1.0
out.publish(t)  # clean
v = Twist(linear=Vector3(msg.data, 1.0, z=2.0))
out.publish(v.linear.x)  # data
out.publish(v.angular)  # clean
out.publish(Twist(**{"linear": msg.linear}).linear)  # data
### a message that is passed on with a change
msg.data = 1.0
out.publish(msg.data)  # clean
out.publish(msg)  # clean
out.publish(msg.other)  # data
### a copy of a message
import copy
t = copy.deepcopy(msg)
t.header.stamp = rospy.Time.now()
out.publish(t.header.stamp)  # clean
out.publish(t.data)  # data
out.publish(t)  # data
### class attributes as constants
class Mode(enum.Enum):
    A = 1
    B = 2
m = Mode.A
out.publish(m.value)  # clean
if msg.data > 0.0:
    m = Mode.B
out.publish(m.value)  # control
out.publish(m == Mode.A)  # control
### local functions in a table
def near():
    return msg.data
def far():
    return 1.0
table = {"n": near, "f": far}
out.publish(table["n"]())  # data
out.publish(table["f"]())  # clean
out.publish(table[rospy.get_name()]())  # data
for f in (far, far):
    out.publish(f())  # clean
out.publish([near, far][1]())  # clean
### functions with defaults that change
def f(x, seen=[]):
    seen.append(x)
    return seen[0]
out.publish(f(msg.data))  # data
### an instance without its class's __init__
class P:
    def __init__(self):
        self.x = msg.data
out.publish(P.__new__(P).x)  # clean
p = P.__new__(P)
p.__init__()
out.publish(p.x)  # data
### a field set by name
class P:
    pass
p = P()
for name in ("a", "b"):
    setattr(p, name, msg.data)
p.c = 1.0
out.publish(p.a)  # data
out.publish(p.c)  # clean
out.publish(getattr(p, "a"))  # data
out.publish(hasattr(p, "a"))  # clean
p.__dict__["d"] = msg.data
out.publish(p.d)  # data
p.__dict__.update(e=msg.data)
out.publish(p.e)  # data
out.publish(vars(p)["c"])  # clean
### a class made in a function
def made(x):
    class P:
        y = x
        def get(self):
            return x
    return P
out.publish(made(msg.data)().get())  # data
out.publish(made(msg.data).y)  # data
### a slot that two methods share
class P:
    def __init__(self):
        self.last = None
        self.n = 0
    def take(self, x):
        before, self.last = self.last, x
        self.n += 1
        return before
p = P()
p.take(msg.data)
out.publish(p.n)  # clean
out.publish(p.take(1.0))  # data
out.publish(p.last)  # clean
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_an_object_holds_the_data_that_was_stored_in_it(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}
