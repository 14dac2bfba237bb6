"""Data and decisions pass through loops, exceptions, context managers and calls of functions as in Python."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

HEAD = """\
import contextlib, rospy
from geometry_msgs.msg import Point
level, fixed = 1.0, 1.0
"""
# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### a loop over few known elements keeps them apart
a, b = 1.0, 1.0
for n, x in [(0, 1.0), (1, msg.data)]:
    if n == 0:
        a = x
    else:
        b = x
out.publish(b)  # data
### a loop over known elements that is left early
for x in [1.0, msg.data, 2.0]:
    if x > 1.5:
        break
out.publish(x)  # data
out.publish(3.0)  # clean
### a loop over known elements with continue and else
total = 0.0
for x in [1.0, msg.data]:
    if rospy.get_time() > 1.0:
        continue
    total += x
else:
    out.publish(1.0)  # clean
out.publish(total)  # data
### a loop that returns
def first():
    for x in [1.0, msg.data]:
        if x > 5.0:
            return x
    return 0.0
def last():
    for x in [1.0, 2.0]:
        return x
out.publish(first())  # data
out.publish(last())  # clean
### a list that an unrolled loop fills
l = []
for x in [1.0, msg.data]:
    l.append(x)
out.publish(l[0])  # clean
out.publish(l[1])  # data
k = []
for x in [1.0, msg.data]:
    if rospy.get_time() > 1.0:
        k.append(x)
out.publish(k[0])  # data
### nested loops over known elements
rows = [[1.0, msg.data], [2.0, 3.0]]
l = []
for row in rows:
    for x in row:
        l.append(x)
out.publish(l)  # data
m = [[x for x in row] for row in rows]
out.publish(m[0][1])  # data
out.publish(m[1][0])  # clean
### a while loop whose state grows
a, b, c, d = 1.0, 1.0, 1.0, 1.0
while rospy.get_time() < 5.0:
    d = c
    c = b
    b = a
    a = msg.data
out.publish(d)  # data
### an inner loop that starts again
for n in range(3):
    x = 1.0
    for m in range(3):
        out.publish(x)  # data
        x = msg.data
### endless loops do not end
def run():
    while True:
        out.publish(1.0)  # control
        if msg.data > 1.0:
            return 2.0
out.publish(run())  # clean
### what follows an endless loop never runs
def run():
    while True:
        pass
    out.publish(msg.data)  # clean
run()
### a condition that is known
DEBUG = False
if DEBUG:
    out.publish(msg.data)  # clean
else:
    out.publish(msg.data)  # data
if not DEBUG and 1 < 2:
    out.publish(msg.data)  # data
while DEBUG:
    out.publish(msg.data)  # clean
### try without handlers
x = 1.0
try:
    x = msg.data
finally:
    out.publish(1.0)  # clean
out.publish(x)  # data
### states before and after each statement reach a handler
a, b = 1.0, 1.0
try:
    a = msg.data
    rospy.wait_for_service("s")
    b = msg.data
    raise ValueError
except ValueError:
    out.publish(a)  # data
    out.publish(b)  # data
else:
    out.publish(2.0)  # clean
### the exception has the data of its arguments
try:
    raise ValueError(msg.data)
except ValueError as error:
    out.publish(error.args[0])  # data
    out.publish(str(error))  # data
try:
    raise ValueError("text")
except ValueError as error:
    out.publish(str(error))  # clean
### an exception that a called function raises
def check(x):
    if x > 1.0:
        raise ValueError(x)
    return 0.0
try:
    y = check(msg.data)
    out.publish(y)  # control
except ValueError as error:
    out.publish(error.args[0])  # data
    out.publish(1.0)  # control
### all handlers end the function
def f():
    try:
        return float(msg.text)
    except ValueError:
        return 0.0
    except TypeError:
        raise
out.publish(f())  # data
### with statements enter and leave
class M:
    def __init__(self):
        self.x = 1.0
    def __enter__(self):
        self.x = msg.data
        return self
    def __exit__(self, *error):
        self.x = 2.0
m = M()
with m as held:
    out.publish(held.x)  # data
    out.publish(m.x)  # data
out.publish(m.x)  # clean
with M() as a, M() as b:
    out.publish(b.x)  # data
### a contextmanager function
@contextlib.contextmanager
def opened(x):
    yield x
with opened(msg.data) as y:
    out.publish(y)  # data
with opened(1.0) as y:
    out.publish(y)  # clean
### globals of the module
def change():
    global level
    level = msg.data
out.publish(fixed)  # clean
change()
out.publish(level)  # data
### star arguments of unknown length
def f(a, b=1.0, *rest, **more):
    out.publish(a)  # data
    out.publish(b)  # data
    out.publish(rest)  # data
    out.publish(more)  # clean
f(*msg.items)
### keyword arguments from an unknown mapping
def f(a=1.0, **more):
    out.publish(a)  # data
    out.publish(more["b"])  # data
f(**msg.table)
### a star argument out of two sequences
def f(a, b):
    out.publish(a)  # clean
    out.publish(b)  # data
f(*([1.0, msg.data] if rospy.get_time() > 1.0 else [2.0, 3.0]))
### calls of one of two functions
def f(x):
    return x
def g(x):
    return 1.0
h = f if rospy.get_time() > 1.0 else g
out.publish(h(msg.data))  # data
def other(x):
    return 2.0
k = f if msg.data > 1.0 else other
out.publish(k(1.0))  # control
### a method of one of two classes
class A:
    def f(self):
        return 1.0
class B:
    def f(self):
        return msg.data
one = A() if rospy.get_time() > 1.0 else B()
out.publish(one.f())  # data
two = A() if msg.data > 1.0 else A()
out.publish(two.f())  # clean
### a function that changes a closed-over list
l = []
def put(x):
    l.append(x)
put(1.0)
put(msg.data)
out.publish(l[-1])  # data
### comparisons of strings and constants
mode = "a" if msg.data > 1.0 else "b"
if mode == "a":
    out.publish(1.0)  # control
other = "a"
if other == "a":
    out.publish(2.0)  # clean
### conditions of methods that answer
class C:
    def __init__(self):
        self.on = False
    def ready(self):
        return self.on
c = C()
if c.ready():
    out.publish(1.0)  # clean
c.on = msg.data > 1.0
if c.ready():
    out.publish(2.0)  # control
if not c.ready() or rospy.is_shutdown():
    out.publish(3.0)  # control
### a value that one of two branches leaves unset
if msg.data > 1.0:
    x = 1.0
else:
    return
out.publish(x)  # control
### None stands for no value
x = None
if msg.data > 1.0:
    x = 1.0
if x is not None:
    out.publish(x)  # control
### chained attributes of a message in a variable
p = msg.pose.position
q = p.x
p = Point()
out.publish(q)  # data
out.publish(p.x)  # clean
### numbers in the names of loops
for i in range(len(msg.items)):
    out.publish(i)  # data
    out.publish(msg.items[i])  # data
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_data_and_control_dependences_are_tracked_through_control_flow(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}
