"""Containers, records, texts, arrays and futures pass on the data of what they contain, and nothing else."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback

# The bodies of a callback `on(msg)`, each below its title.
PROGRAMS = """\
### lists grow
l = [1.0]
l.append(msg.data)
out.publish(l[0])  # data
k = []
k.append(1.0)
k.extend([2.0, msg.data])
out.publish(k[1])  # data
m = [1.0]
m.insert(0, 2.0)
m.extendleft([3.0])
out.publish(m[0])  # clean
m += [msg.data]
out.publish(m[-1])  # data
out.publish(len(m))  # clean
m += msg.items
out.publish(len(m))  # data
### parts of lists
l = [msg.data, 1.0, 2.0]
out.publish(l[1:][0])  # clean
out.publish(l[:1][0])  # data
out.publish(l[-2:][1])  # clean
out.publish(l[::2][0])  # data
out.publish(l[::-1][2])  # data
out.publish(l[::-1][0])  # clean
out.publish(l[1:])  # clean
out.publish(len(l[1:]))  # clean
out.publish(l[msg.count:])  # data
out.publish(len(l[msg.count:]))  # data
out.publish(l[msg.count:2][1])  # data
k = l[1:] + [msg.data]
out.publish(k[0])  # clean
out.publish(k[2])  # data
m = list(msg.items)
out.publish(m[1:3][0])  # data
### captures of patterns
match (msg.data, 1.0, 2.0):
    case (first, *rest):
        out.publish(first)  # data
        out.publish(rest[0])  # clean
        out.publish(rest)  # clean
match (1.0, 2.0, msg.data):
    case (*rest, last):
        out.publish(last)  # data
        out.publish(rest)  # clean
match (1.0, msg.data, 2.0):
    case (_, *rest, _):
        out.publish(rest[0])  # data
### a dict literal replaces entries
d = {"x": msg.data, "y": msg.data}
d.update({"x": 1.0})
out.publish(d["x"])  # clean
out.publish(d["y"])  # data
d.update(y=2.0)
out.publish(d["y"])  # clean
e = {"x": msg.data} | {"x": 1.0, "z": msg.data}
out.publish(e["x"])  # clean
out.publish(e["z"])  # data
e.update({msg.name: 1.0})
out.publish(e["z"])  # data
f = {"x": msg.data}
g = {"y": 1.0}
if rospy.get_time() > 3.0:
    g["x"] = 2.0
f.update(g)
out.publish(f["x"])  # data
h = f if rospy.get_time() > 3.0 else e
h.update({"x": 1.0})
out.publish(f["x"])  # data
### a mapping whose keys are not known may replace any entry
words = {item[0]: item[1] for item in msg.items}
d = {"x": 1.0, "y": 2.0}
d.update(words)
out.publish(d["x"])  # data
out.publish(({"x": 1.0} | words)["x"])  # data
out.publish({"x": 1.0, **words}["x"])  # data
out.publish({**words, "x": 1.0}["x"])  # clean
### what is zipped with known elements only ends them early
d = dict(zip(("a", "b", "c", "d", "e"), msg.items))
out.publish(d["a"])  # data
out.publish([key for key in d])  # control
out.publish([key for key, value in d.items() if value > 6.0])  # control
out.publish(len(list(zip(msg.items, msg.items))))  # data
### lists shrink
l = [msg.data, 1.0]
out.publish(l.pop())  # data
l.clear()
out.publish(l)  # clean
l.append(1.0)
out.publish(l[0])  # clean
k = [1.0, 2.0]
del k[0]
out.publish(k[0])  # clean
m = [1.0, 2.0]
m.remove(msg.data)
out.publish(len(m))  # clean
### an addition under a condition decides the length only
l = [1.0]
if msg.data > 0.0:
    l.append(2.0)
out.publish(len(l))  # control
out.publish(l[0])  # control
for x in l:
    out.publish(3.0)  # control
### concatenation, repetition and slices
l = [1.0, msg.data] + [2.0]
out.publish(l[0])  # clean
out.publish(l[1])  # data
out.publish(l[2])  # clean
out.publish(([1.0] * 3)[0])  # clean
out.publish((3 * [msg.data])[0])  # data
out.publish(len([1.0] * msg.count))  # data
out.publish(([1.0] * msg.count)[0])  # clean
out.publish((1.0, msg.data)[1:][0])  # data
out.publish(sum([[msg.data], [1.0]], []))  # data
out.publish(([1.0] + msg.items)[0])  # data
out.publish((msg.items + [1.0])[0])  # data
### sets
s = {1.0, 2.0}
out.publish(s | {msg.data})  # data
out.publish(len(s | {3.0}))  # clean
out.publish(s & {3.0})  # clean
out.publish(s - {msg.data})  # control
out.publish({1.0}.union([msg.data]))  # data
s.add(msg.data)
out.publish(s.pop())  # data
s.discard(1.0)
out.publish(1.0 in s)  # data
### unions of dicts
d = {"a": msg.data} | {"b": 1.0}
out.publish(d["a"])  # data
out.publish(d["b"])  # clean
e = {"a": 1.0}
e |= {"b": msg.data}
out.publish(e["a"])  # clean
out.publish(e["b"])  # data
e.update({"a": msg.data}, c=1.0)
out.publish(e["a"])  # data
out.publish(e["c"])  # clean
e.update([("d", msg.data), ("f", 1.0)])
out.publish(e["d"])  # data
out.publish(e["f"])  # clean
f = {**{"a": msg.data}, "a": 1.0, "b": 2.0}
out.publish(f["a"])  # clean
### entries of a dict
d = {"a": msg.data, "b": 1.0}
out.publish(d.get("a", 2.0))  # data
out.publish(d.get("b", 2.0))  # clean
out.publish(d.get("c"))  # clean
out.publish(d.get(msg.name))  # data
out.publish(d.pop("b"))  # clean
out.publish(len(d))  # clean
for key in d:
    out.publish(key)  # clean
    out.publish(d[key])  # data
for key, value in d.items():
    out.publish(key)  # clean
    out.publish(value)  # data
out.publish(list(d))  # clean
out.publish(list(d.values()))  # data
out.publish(sorted(d)[0])  # clean
out.publish(max(d, key=d.get))  # control
### keys that are data
d = {}
d[msg.name] = 1.0
out.publish(d["a"])  # data
out.publish("a" in d)  # data
for key in d:
    out.publish(key)  # data
### a dict of lists
from collections import defaultdict, deque, OrderedDict, Counter
d = defaultdict(list)
d["a"].append(msg.data)
d["b"].append(1.0)
out.publish(d["a"][0])  # data
out.publish(d["b"][0])  # clean
out.publish(d["c"])  # clean
e = defaultdict(lambda: [msg.data])
out.publish(e["a"][0])  # data
f = {}
f.setdefault("a", []).append(msg.data)
out.publish(f["a"][0])  # data
g = defaultdict(dict)
g["a"]["x"] = msg.data
out.publish(g["a"]["x"])  # data
out.publish(g["b"]["x"])  # clean
h = defaultdict(float)
h["a"] += msg.data
out.publish(h["a"])  # data
out.publish(h["b"])  # clean
### queues with a length
from collections import deque
q = deque([1.0], maxlen=3)
q.append(1.0)
out.publish(q[0])  # clean
q.appendleft(msg.data)
out.publish(q[0])  # data
out.publish(q.popleft())  # data
out.publish(len(q))  # clean
q.rotate(1)
### iterators
i = iter([1.0, msg.data])
out.publish(next(i))  # data
out.publish(next(iter([1.0]), 2.0))  # clean
out.publish(next(iter([1.0]), msg.data))  # data
for a, b in zip([1.0, 2.0], [msg.data, 3.0]):
    out.publish(a)  # clean
    out.publish(b)  # data
a, b = zip(*[(1.0, msg.data), (2.0, 3.0)])
out.publish(a[0])  # clean
out.publish(b[0])  # data
for n, (a, b) in enumerate([(1.0, msg.data)]):
    out.publish(n)  # clean
    out.publish(a)  # clean
    out.publish(b)  # data
out.publish(list(reversed([1.0, msg.data]))[0])  # data
out.publish(list(reversed([1.0, msg.data]))[1])  # clean
out.publish(list(map(lambda x: x + msg.data, [1.0]))[0])  # data
out.publish(list(map(lambda x: x, [1.0, msg.data]))[0])  # clean
out.publish(list(map(lambda x, y: y, [msg.data], [1.0]))[0])  # clean
out.publish(list(filter(lambda x: x > msg.data, [1.0, 2.0]))[0])  # control
out.publish(len(list(filter(None, [1.0, 2.0]))))  # clean
out.publish(list(filter(None, msg.items))[0])  # data
out.publish(list(range(msg.count))[0])  # data
out.publish(sum(range(3)))  # clean
### numbers of a sequence
out.publish(min(1.0, msg.data))  # data
out.publish(max([1.0, 2.0]))  # clean
out.publish(sum(msg.items))  # data
out.publish(any([1.0, msg.data]))  # data
out.publish(all([1.0, 2.0]))  # clean
out.publish(len([msg.data]))  # clean
out.publish(len(msg.items))  # data
out.publish(len("text"))  # clean
out.publish(len(msg.text))  # data
out.publish(bool(msg.items))  # data
out.publish(bool([msg.data]))  # clean
out.publish(round(msg.data, 2))  # data
out.publish(divmod(msg.data, 2.0)[0])  # data
out.publish(abs(-1.0))  # clean
### texts
out.publish("{} {}".format(1.0, msg.data))  # data
out.publish("{a}".format(a=1.0, b=2.0))  # clean
out.publish("-".join(["a", msg.text]))  # data
out.publish("-".join({"a": msg.data}))  # clean
out.publish("-".join({msg.text: 1.0}))  # data
out.publish(msg.text.split(",")[0])  # data
out.publish("a,b".split(",")[0])  # clean
out.publish("a".replace("a", msg.text))  # data
out.publish(str(msg.data))  # data
out.publish(repr(1.0))  # clean
out.publish("a" in msg.text)  # data
out.publish(msg.text[0])  # data
out.publish(msg.text.upper().strip())  # data
out.publish("a".upper())  # clean
out.publish(int("1"))  # clean
out.publish(int(msg.text))  # data
out.publish(ord(msg.text))  # data
### copies share what is inside
import copy
l = [[1.0], 2.0]
k = copy.copy(l)
m = copy.deepcopy(l)
n = list(l)
l[0].append(msg.data)
l[1] = msg.data
out.publish(k[0])  # data
out.publish(k[1])  # clean
out.publish(m[0])  # clean
out.publish(m[1])  # clean
out.publish(n[0])  # data
out.publish(n[1])  # clean
out.publish(l[1])  # data
### a deep copy of three levels
import copy
d = {"a": {"b": {"c": [1.0]}}}
e = copy.deepcopy(d)
e["a"]["b"]["c"].append(msg.data)
out.publish(e["a"]["b"]["c"])  # data
out.publish(d["a"]["b"]["c"])  # clean
f = d.copy()
f["a"] = msg.data
out.publish(d["a"])  # clean
f = d
f["a"] = msg.data
out.publish(d["a"])  # data
### data classes
import dataclasses
from dataclasses import dataclass, field
@dataclass
class P:
    x: float
    y: float = 1.0
    z: list = field(default_factory=list)
    w: float = field(init=False, default=2.0)
    def __post_init__(self):
        self.v = self.x
@dataclass
class Q(P):
    u: float = 3.0
p, q = P(msg.data), P(1.0, y=msg.data)
out.publish(p.x)  # data
out.publish(p.y)  # clean
out.publish(p.v)  # data
out.publish(q.x)  # clean
out.publish(q.y)  # data
out.publish(q.v)  # clean
p.z.append(msg.data)
out.publish(p.z)  # data
out.publish(q.z)  # clean
out.publish(p.w)  # clean
r = Q(1.0, 2.0, [], msg.data)
out.publish(r.u)  # data
out.publish(r.y)  # clean
out.publish(P(**{"x": msg.data, "y": 1.0}).x)  # data
out.publish(P(**{"x": msg.data, "y": 1.0}).y)  # clean
out.publish(P(*[1.0, msg.data]).y)  # data
out.publish(P(*msg.items).y)  # data
s = dataclasses.replace(q, x=msg.data)
out.publish(s.x)  # data
out.publish(s.y)  # data
out.publish(dataclasses.replace(q, y=1.0).y)  # clean
out.publish(q.y)  # data
out.publish(dataclasses.asdict(q)["y"])  # data
out.publish(dataclasses.asdict(q)["x"])  # clean
out.publish(dataclasses.astuple(q)[1])  # data
out.publish(dataclasses.astuple(q)[0])  # clean
### annotations of a class without a decorator are no fields
class P:
    x: float = 1.0
    def __init__(self, x):
        pass
out.publish(P(msg.data).x)  # clean
### named tuples
from collections import namedtuple
from typing import NamedTuple
P = namedtuple("P", ["x", "y"])
class Q(NamedTuple):
    x: float
    y: float = 1.0
p, q = P(msg.data, 1.0), Q(msg.data)
out.publish(p.x)  # data
out.publish(p[1])  # clean
out.publish(q.x)  # data
out.publish(q.y)  # clean
a, b = q
out.publish(a)  # data
out.publish(b)  # clean
r = p._replace(x=1.0)
out.publish(r.x)  # clean
out.publish(r[0])  # clean
out.publish(p._replace(y=msg.data)[1])  # data
out.publish(p._asdict()["x"])  # data
out.publish(p._asdict()["y"])  # clean
### numbers of arrays
import numpy as np
a = np.array([1.0, msg.data])
out.publish(a)  # data
out.publish(a.mean())  # data
out.publish(np.zeros(3)[0])  # clean
b = np.zeros(3)
b[0] = msg.data
out.publish(b[0])  # data
out.publish(b.shape)  # clean
out.publish(np.zeros(msg.count))  # data
c = np.zeros(3)
np.copyto(c, a)
out.publish(c)  # data
d = np.zeros(3)
np.add(a, 1.0, out=d)
out.publish(d)  # data
e = np.zeros(3)
e.fill(msg.data)
out.publish(e)  # data
f = np.zeros(3)
f[:] = a
out.publish(f[1])  # data
### partial functions and operators
import functools, operator
f = functools.partial(lambda a, b, c: [a, b, c], msg.data, c=1.0)
out.publish(f(2.0)[0])  # data
out.publish(f(2.0)[1])  # clean
out.publish(f(2.0)[2])  # clean
out.publish(f(msg.data)[1])  # data
out.publish(functools.reduce(lambda a, b: a + b, [1.0, msg.data]))  # data
out.publish(functools.reduce(lambda a, b: a, [1.0, 2.0], msg.data))  # data
out.publish(operator.add(1.0, msg.data))  # data
out.publish(operator.itemgetter(1)([msg.data, 1.0]))  # clean
### streams in memory
import io, json, pickle
a, b, c, d, e = io.StringIO(), io.StringIO(), io.BytesIO(), io.BytesIO(), io.StringIO()
json.dump({"x": msg.data}, a)
out.publish(a.getvalue())  # data
print("x", msg.data, file=b)
out.publish(b.getvalue())  # data
pickle.dump(msg.data, c)
out.publish(c.getvalue())  # data
msg.serialize(d)
out.publish(d.getvalue())  # data
json.dump({"x": 1.0}, e)
out.publish(e.getvalue())  # clean
### attributes of an object as a mapping
class Side:
    def __init__(self):
        self.name, self.speed = "left", msg.data
side = Side()
for key, value in vars(side).items():
    if key == "name":
        out.publish(value)  # clean
    else:
        out.publish(value)  # data
out.publish(" ".join(vars(side)))  # clean
out.publish(" ".join(key for key, _ in sorted(vars(side).items())))  # clean
out.publish(max(v for v in vars(side).values()))  # data
out.publish(len(vars(side)))  # clean
### sorting by data
l = [1.0, 2.0]
l.sort(key=lambda x: x * msg.data)
out.publish(l[0])  # control
k = [1.0, 2.0]
k.sort()
out.publish(k[0])  # clean
out.publish(sorted([1.0, 2.0], key=lambda x: -x)[0])  # clean
out.publish(sorted([(1.0, msg.data), (2.0, 0.0)], key=lambda p: p[1])[0][0])  # control
out.publish(min([1.0, 2.0], key=lambda x: abs(x - msg.data)))  # control
### streams and files
import io, json
s = io.StringIO()
s.write(msg.text)
out.publish(s.getvalue())  # data
t = io.StringIO()
out.publish(t.getvalue())  # clean
out.publish(json.loads(msg.text)["a"])  # data
out.publish(json.dumps({"a": 1.0}))  # clean
with open("a.txt", "w") as f:
    f.write(msg.text)
    out.publish(f.name)  # clean
### futures and events
import threading
from concurrent.futures import Future, ThreadPoolExecutor
f, g = Future(), Future()
f.set_result(msg.data)
g.set_result(1.0)
out.publish(f.result())  # data
out.publish(g.result())  # clean
out.publish(f.done())  # clean
with ThreadPoolExecutor() as pool:
    out.publish(pool.submit(lambda x: x, msg.data).result())  # data
    out.publish(pool.submit(lambda x: 1.0, msg.data).result())  # clean
    out.publish(list(pool.map(lambda x: x, [msg.data]))[0])  # data
e = threading.Event()
if msg.data > 0.0:
    e.set()
out.publish(e.is_set())  # control
h = threading.Event()
h.set()
out.publish(h.is_set())  # clean
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_a_container_has_the_data_of_its_elements(title):
    assert differing(in_callback(CASES[title])) == {}
