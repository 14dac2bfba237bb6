"""Statements, expressions and functions pass data on as Python does."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

HEAD = """\
import asyncio, rospy
"""
# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### an assignment replaces the data of a name
x = msg.data
out.publish(x)  # data
x = 1.0
out.publish(x)  # clean
### an augmented assignment keeps the data of both sides
x, y = 1.0, msg.data
x += msg.data
y -= 1.0
out.publish(x)  # data
out.publish(y)  # data
### an annotated assignment
x: float = msg.data
y: float = 1.0
out.publish(x)  # data
out.publish(y)  # clean
### unpacking gives each target its element
(a, (b, c)), *rest = (1.0, (msg.data, 2.0)), 3.0, msg.data
out.publish(a)  # clean
out.publish(b)  # data
out.publish(c)  # clean
out.publish(rest[0])  # clean
out.publish(rest[1])  # data
first, *others = msg.items
out.publish(first)  # data
out.publish(others[0])  # data
*more, last = [msg.data, 1.0, 2.0]
out.publish(last)  # clean
out.publish(more[0])  # data
### unpacking a starred literal
a, b, c = [*(1.0, msg.data), 2.0]
out.publish(b)  # data
### a swap exchanges the data
a, b = msg.data, 1.0
a, b = b, a
out.publish(a)  # clean
out.publish(b)  # data
### several targets
a = b = msg.data
b = 1.0
out.publish(a)  # data
out.publish(b)  # clean
### an assignment to an item of a known key replaces only that item
d = {"a": msg.data, "b": 1.0}
d["b"] = msg.data
d["a"] = 1.0
out.publish(d["a"])  # clean
out.publish(d["b"])  # data
### an item of an unknown key may be any item
d = {"a": 1.0, "b": 1.0}
d[rospy.get_name()] = msg.data
out.publish(d["a"])  # data
l = [1.0, 1.0]
l[rospy.get_time() > 5.0] = msg.data
out.publish(l[0])  # data
### a key that is data decides which item is read
d = {"a": 1.0, "b": 2.0}
out.publish(d[msg.name])  # data
out.publish(d["a"])  # clean
### an item of an item
l = [[1.0, msg.data], [2.0, 3.0]]
out.publish(l[0][1])  # data
out.publish(l[0][0])  # clean
out.publish(l[1][1])  # clean
l[1][1] = msg.data
out.publish(l[1][1])  # data
out.publish(l[-1])  # data
### an index from the end
l = [1.0, msg.data]
out.publish(l[-1])  # data
out.publish(l[-2])  # clean
### a slice
l = [1.0, 2.0, msg.data]
out.publish(l[1:][0])  # clean
out.publish(l[1:][1])  # data
out.publish([1.0, 2.0][:1][0])  # clean
out.publish(len(l[1:]))  # clean
out.publish(len([1.0, 2.0][:msg.count]))  # data
out.publish("text"[:msg.count])  # data
out.publish(msg.items[1:3][0])  # data
### a slice as a target
l = [1.0, 2.0]
l[0:1] = [msg.data]
out.publish(l[0])  # data
k = [1.0, 2.0]
k[:] = [3.0]
out.publish(k[0])  # clean
### a deleted item is gone
d = {"a": msg.data, "b": 1.0}
del d["a"]
out.publish(d.get("a"))  # clean
out.publish(d["b"])  # clean
out.publish(len(d))  # clean
### a deleted name and attribute
x = msg.data
del x
x = 1.0
out.publish(x)  # clean
### an operation has the data of its operands
x = msg.data
out.publish(-x)  # data
out.publish(not x)  # data
out.publish(1.0 < x)  # data
out.publish(1.0 < x < 2.0)  # data
out.publish(2.0 ** x)  # data
out.publish(x @ x)  # data
out.publish(1.0 + 2.0)  # clean
out.publish(f"{x}")  # data
out.publish(f"{1.0:{x}}")  # data
out.publish(f"{1.0!r:>5}")  # clean
out.publish("%s %s" % (1.0, x))  # data
out.publish("%s" % 1.0)  # clean
out.publish(lambda: x)  # clean
out.publish([x for _ in range(2)])  # data
out.publish({"a": x})  # data
out.publish({x: 1.0})  # data
out.publish((1.0, 2.0))  # clean
out.publish({1.0, x})  # data
out.publish({*[x]})  # data
out.publish({**{"a": x}})  # data
out.publish([*[1.0]])  # clean
### and, or
x = msg.data
out.publish(x or 1.0)  # data
out.publish(1.0 or x)  # clean
out.publish(0.0 and x)  # clean
out.publish(x and 1.0)  # data
### an identity with None says nothing of the data
x = msg.data
out.publish(x is None)  # clean
out.publish(x is not None)  # clean
### whether an element is in a container depends on the elements and on the sought one
out.publish(1.0 in [2.0, msg.data])  # data
out.publish(msg.data in [2.0])  # data
out.publish(1.0 in [2.0])  # clean
out.publish("a" in {"a": msg.data})  # clean
out.publish("a" not in {msg.name: 1.0})  # data
### a conditional expression
out.publish(1.0 if msg.data > 0.0 else 2.0)  # control
out.publish(msg.data if rospy.get_time() > 1.0 else 2.0)  # data
out.publish(1.0 if rospy.get_time() > 1.0 else 2.0)  # clean
out.publish(1.0 if msg.data > 0.0 else 1.0)  # clean
### an assignment expression
if (x := msg.data) > 0.0:
    out.publish(1.0)  # control
out.publish(x)  # data
out.publish([y := 1.0, y][1])  # clean
### a comprehension keeps its variable inside
x = 1.0
l = [x for x in msg.items]
out.publish(x)  # clean
out.publish(l[0])  # data
out.publish(len([1.0 for _ in msg.items]))  # data
out.publish(len([1.0 for y in [1.0, 2.0] if y > msg.data]))  # control
out.publish([z for y in [[msg.data]] for z in y][0])  # data
out.publish({k: v for k, v in [("a", msg.data), ("b", 1.0)]}["a"])  # data
out.publish(sum(y for y in [1.0, 2.0]))  # clean
out.publish(sum(y for y in [1.0, msg.data]))  # data
### a loop over data
for item in msg.items:
    out.publish(item)  # data
    out.publish(1.0)  # control
out.publish(2.0)  # clean
### a loop over known elements
for item in [1.0, msg.data]:
    out.publish(item)  # data
for number, item in enumerate([1.0, msg.data]):
    out.publish(number)  # clean
### a loop that data ends
n = 0
while n < msg.count:
    out.publish(n)  # control
    n += 1
out.publish(n)  # control
### a break decides what follows it in the loop and its else
for n in range(3):
    if msg.data > n:
        break
    out.publish(1.0)  # control
else:
    out.publish(2.0)  # control
out.publish(3.0)  # clean
### a continue decides the rest of its turn
for n in range(3):
    if msg.data > n:
        continue
    out.publish(1.0)  # control
out.publish(3.0)  # clean
### a value carried from turn to turn
a, b = 1.0, 1.0
for _ in range(3):
    out.publish(a)  # data
    a = b
    b = msg.data
out.publish(a)  # data
### a return decides what follows it
if msg.data > 0.0:
    return
out.publish(1.0)  # control
### a branch without effect on a value does not decide it
if msg.data > 0.0:
    rospy.loginfo("positive")
out.publish(1.0)  # clean
### data branches give a value
if msg.data > 0.0:
    x = 1.0
else:
    x = 2.0
out.publish(x)  # control
if msg.data > 0.0:
    y = 1.0
else:
    y = 1.0
out.publish(y)  # clean
### nested conditions
if rospy.get_time() > 1.0:
    if msg.data > 0.0:
        out.publish(1.0)  # control
    out.publish(2.0)  # clean
elif msg.count:
    out.publish(3.0)  # control
else:
    out.publish(4.0)  # control
### a handler of an exception that data may raise
try:
    x = float(msg.text)
except ValueError:
    out.publish(1.0)  # control
    return
out.publish(2.0)  # control
out.publish(x)  # data
### an exception that a check of data raises
try:
    if msg.data > 0.0:
        raise ValueError
    out.publish(1.0)  # control
except ValueError:
    out.publish(2.0)  # control
else:
    out.publish(3.0)  # control
finally:
    out.publish(4.0)  # clean
### a value that a try may not reach
x = 1.0
try:
    rospy.wait_for_service("a")
    x = msg.data
except rospy.ROSException:
    pass
out.publish(x)  # data
### a raise ends the function
if msg.data > 0.0:
    raise ValueError
out.publish(1.0)  # control
### an assertion
assert msg.data > 0.0
out.publish(1.0)  # control
### a with statement
with open(msg.path) as file:
    out.publish(file.read())  # data
    out.publish(1.0)  # clean
### match
match msg.mode:
    case 1:
        out.publish(1.0)  # control
    case [a, b]:
        out.publish(a)  # data
    case {"k": v, **rest}:
        out.publish(v)  # data
        out.publish(rest["z"])  # data
    case str() as text:
        out.publish(text)  # data
    case _:
        out.publish(2.0)  # control
### match of something that is no data
match rospy.get_name():
    case "a" if msg.data > 0.0:
        out.publish(1.0)  # control
    case "b" | "c":
        out.publish(2.0)  # control
    case _:
        out.publish(3.0)  # control
### a nested function sees the names around it
x = msg.data
def inner(y):
    return x + y
def other(y):
    return y
out.publish(inner(1.0))  # data
out.publish(other(1.0))  # clean
out.publish(other(msg.data))  # data
out.publish((lambda a, b=x: b)(1.0))  # data
out.publish((lambda a, b=x: a)(1.0))  # clean
### a nested function that changes a name around it
x = 1.0
def change():
    nonlocal x
    x = msg.data
out.publish(x)  # clean
change()
out.publish(x)  # data
### arguments reach their parameters
def f(a, b=1.0, *rest, c=2.0, **more):
    return {"a": a, "b": b, "rest": rest, "c": c, "more": more}
out.publish(f(msg.data)["a"])  # data
out.publish(f(msg.data)["b"])  # clean
out.publish(f(1.0, msg.data)["b"])  # data
out.publish(f(1.0, 1.0, msg.data)["rest"][0])  # data
out.publish(f(1.0, 1.0, msg.data)["b"])  # clean
out.publish(f(1.0, c=msg.data)["c"])  # data
out.publish(f(1.0, c=msg.data)["more"])  # clean
out.publish(f(1.0, d=msg.data)["more"]["d"])  # data
out.publish(f(1.0, d=msg.data)["c"])  # clean
out.publish(f(*[1.0, msg.data])["b"])  # data
out.publish(f(*[1.0, msg.data])["a"])  # clean
out.publish(f(**{"a": 1.0, "b": msg.data})["b"])  # data
out.publish(f(**{"a": 1.0, "b": msg.data})["a"])  # clean
out.publish(f(*msg.items)["b"])  # data
out.publish(f(b=msg.data, a=1.0)["a"])  # clean
### positional-only and keyword-only parameters
def f(a, /, b, *, c):
    return [a, b, c]
out.publish(f(msg.data, 1.0, c=2.0)[0])  # data
out.publish(f(msg.data, 1.0, c=2.0)[1])  # clean
out.publish(f(1.0, b=msg.data, c=2.0)[1])  # data
out.publish(f(1.0, 2.0, c=msg.data)[2])  # data
out.publish(f(1.0, 2.0, c=msg.data)[0])  # clean
### a function that changes its argument
def fill(l, d, s):
    l.append(msg.data)
    d["k"] = msg.data
    s = msg.data
l, d, s = [], {}, 1.0
fill(l, d, s)
out.publish(l[0])  # data
out.publish(d["k"])  # data
out.publish(s)  # clean
### recursion
def down(n, x):
    return x if n == 0 else down(n - 1, x)
out.publish(down(3, msg.data))  # data
out.publish(down(3, 1.0))  # clean
### several returns
def f(n):
    if n > 1.0:
        return 1.0
    return 2.0
out.publish(f(msg.data))  # control
out.publish(f(3.0))  # clean
### a generator
def steps():
    yield 1.0
    yield msg.data
def even():
    yield from steps()
    return
def none():
    yield 1.0
for x in steps():
    out.publish(x)  # data
for x in even():
    out.publish(x)  # data
for x in none():
    out.publish(x)  # clean
out.publish(list(steps())[0])  # data
out.publish(next(none()))  # clean
### a decorated function
def twice(f):
    def inner(*args, **keywords):
        return 2.0 * f(*args, **keywords)
    return inner
@twice
def near(a, b=1.0):
    return a
@twice
def far(a, b=1.0):
    return b
out.publish(near(msg.data))  # data
out.publish(far(msg.data))  # clean
out.publish(far(1.0, b=msg.data))  # data
### an asynchronous function
async def near():
    return msg.data
async def both():
    x = await near()
    async for y in more():
        out.publish(y)  # clean
    async with lock as held:
        out.publish(x)  # data
        out.publish(1.0)  # clean
async def more():
    yield 1.0
asyncio.run(both())
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_data_moves_through_a_program_as_in_python(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}
