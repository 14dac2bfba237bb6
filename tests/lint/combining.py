"""Nodes composed of parts: kinds of state, callbacks, messages, publishers and main programs."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import indent
from typing import Final

# Code of `__init__`, code of the callback with VALUE, its read access, and a read of state without data.
STATES: Final[Mapping[str, tuple[str, str, str, str]]] = {
    "attribute": ("self.x = 0.0\nself.y = 1.0", "self.x = VALUE", "value = self.x", "clean = self.y"),
    "attribute of attribute": (
        "self.s = Store()\nself.t = Store()",
        "self.s.x = VALUE",
        "value = self.s.x",
        "clean = self.t.x",
    ),
    "list element": ("self.l = [0.0, 1.0]", "self.l[0] = VALUE", "value = self.l[0]", "clean = self.l[1]"),
    "append": (
        "self.l = []\nself.k = [1.0]",
        "self.l.append(VALUE)",
        "value = self.l[-1]",
        "clean = self.k[-1]",
    ),
    "extend": (
        "self.l = []\nself.k = []",
        "self.l.extend([VALUE, 1.0])",
        "value = sum(self.l)",
        "clean = sum(self.k)",
    ),
    "insert": (
        "self.l = []\nself.k = [0.0]",
        "self.l.insert(0, VALUE)",
        "value = self.l[0]",
        "clean = self.k[0]",
    ),
    "augmented": (
        "self.total = 0.0\nself.n = 0",
        "self.total += VALUE\nself.n += 1",
        "value = self.total",
        "clean = self.n",
    ),
    "list augmented": (
        "self.l = []\nself.k = [0.0]",
        "self.l += [VALUE]",
        "value = max(self.l)",
        "clean = max(self.k)",
    ),
    "dict": (
        'self.d = {"a": 0.0, "b": 1.0}',
        'self.d["a"] = VALUE',
        'value = self.d["a"]',
        'clean = self.d["b"]',
    ),
    "dict update": (
        'self.d = {"a": 0.0, "b": 1.0}',
        "self.d.update(a=VALUE)",
        'value = self.d["a"]',
        'clean = self.d["b"]',
    ),
    "dict update literal": (
        'self.d = {"a": 0.0, "b": 1.0}',
        'self.d.update({"a": VALUE})',
        'value = self.d.get("a")',
        'clean = self.d.get("b", 0.0)',
    ),
    "setdefault": (
        'self.d = {}\nself.e = {"a": 1.0}',
        'self.d.setdefault("a", VALUE)',
        'value = self.d["a"]',
        'clean = self.e["a"]',
    ),
    "setdefault list": (
        'self.d = {}\nself.e = {"a": [1.0]}',
        'self.d.setdefault("a", []).append(VALUE)',
        'value = self.d["a"][0]',
        'clean = self.e["a"][0]',
    ),
    "deque": (
        "self.q = deque(maxlen=5)\nself.r = deque([0.0], maxlen=5)",
        "self.q.append(VALUE)",
        "value = sum(self.q) / len(self.q)",
        "clean = sum(self.r)",
    ),
    "set": (
        "self.s = set()\nself.t = {1.0}",
        "self.s.add(VALUE)",
        "value = max(self.s)",
        "clean = max(self.t)",
    ),
    "tuple": ("self.t = (0.0, 1.0)", "self.t = (VALUE, 1.0)", "value, clean0 = self.t", "clean = self.t[1]"),
    "global": ("pass", "global g_x\ng_x = VALUE", "value = g_x", "clean = g_y"),
    "global list": ("pass", "g_list[0] = VALUE", "value = g_list[0]", "clean = g_list[1]"),
    "global object": ("pass", "g_store.x = VALUE", "value = g_store.x", "clean = g_store.y"),
    "class attribute": ("pass", "type(self).shared = VALUE", "value = self.shared", "clean = Node.fixed"),
    "class attribute by name": ("pass", "Node.shared = VALUE", "value = Node.shared", "clean = self.fixed"),
    "class list": ("pass", "self.history.append(VALUE)", "value = Node.history[-1]", "clean = self.fixed"),
    "property": ("self._p = 0.0\nself.y = 1.0", "self.prop = VALUE", "value = self.prop", "clean = self.y"),
    "dataclass": (
        "self.d = Data()\nself.e = Data(b=3.0)",
        "self.d.a = VALUE",
        "value = self.d.a",
        "clean = self.d.b",
    ),
    "dataclass replace": (
        "self.d = Data()",
        "self.d = replace(self.d, a=VALUE)",
        "value = self.d.a",
        "clean = self.d.b",
    ),
    "named tuple": (
        "self.p = Pair(0.0, 1.0)",
        "self.p = self.p._replace(a=VALUE)",
        "value = self.p.a",
        "clean = self.p.b",
    ),
    "numpy": (
        "self.m = np.zeros(3)\nself.k = np.zeros(3)",
        "self.m[0] = VALUE",
        "value = float(np.mean(self.m))",
        "clean = self.k[0]",
    ),
    "numpy roll": (
        "self.m = np.zeros(3)\nself.k = np.zeros(3)",
        "self.m = np.roll(self.m, 1)\nself.m[0] = VALUE",
        "value = self.m.mean()",
        "clean = self.k.mean()",
    ),
    "queue": (
        "self.q = queue.Queue()\nself.r = queue.Queue()",
        "self.q.put(VALUE)",
        "value = self.q.get()",
        "clean = self.r.get()",
    ),
    "closure": (
        "self.keep, self.give = cell()\nself.keep2, self.give2 = cell()",
        "self.keep(VALUE)",
        "value = self.give()",
        "clean = self.give2()",
    ),
    "lock": (
        "self.lock = threading.Lock()\nself.x = 0.0\nself.y = 1.0",
        "with self.lock:\n    self.x = VALUE",
        "with self.lock:\n    value = self.x",
        "clean = self.y",
    ),
    "unpacking": (
        "self.x, self.y = 0.0, 1.0",
        "self.x, self.z = VALUE, 2.0",
        "value = self.x",
        "clean = self.y + self.z",
    ),
    "chained": (
        "self.x = self.w = 0.0\nself.y = 1.0",
        "self.x = self.w = VALUE",
        "value = self.w",
        "clean = self.y",
    ),
    "rotated": (
        "self.b = [0.0] * 4\nself.k = [0.0] * 4",
        "self.b = self.b[1:] + [VALUE]",
        "value = self.b[0]",
        "clean = self.k[0]",
    ),
    "slice store": (
        "self.b = [0.0] * 4\nself.k = [0.0] * 4",
        "self.b[:2] = [VALUE, VALUE]",
        "value = self.b[1]",
        "clean = self.k[0]",
    ),
    "nested dict": (
        'self.d = {"a": {"x": 0.0}, "b": {"x": 0.0}}',
        'self.d["a"]["x"] = VALUE',
        'value = self.d["a"]["x"]',
        'clean = self.d["b"]["x"]',
    ),
    "dict of objects": (
        'self.d = {"a": Store(), "b": Store()}',
        'self.d["a"].set(VALUE)',
        'value = self.d["a"].get()',
        'clean = self.d["b"].get()',
    ),
    "method of object": (
        "self.s = Store()\nself.t = Store()",
        "self.s.set(VALUE)",
        "value = self.s.get()",
        "clean = self.t.get()",
    ),
    "setattr": (
        "self.x = 0.0\nself.y = 0.0",
        'setattr(self, "x", VALUE)',
        'value = getattr(self, "x")',
        'clean = getattr(self, "y")',
    ),
    "defaultdict": (
        "self.d = defaultdict(list)\nself.e = defaultdict(list)",
        'self.d["a"].append(VALUE)',
        'value = self.d["a"][-1]',
        "clean = len(self.e)",
    ),
    "aliased list": (
        "self.l = []\nself.view = self.l\nself.k = [0.0]",
        "self.l.append(VALUE)",
        "value = self.view[0]",
        "clean = self.k[0]",
    ),
    "future": (
        "self.f = Future()\nself.g = Future()",
        "self.f.set_result(VALUE)",
        "value = self.f.result()",
        "clean = self.g.result()",
    ),
    "heap": (
        "self.h = []\nself.k = [0.0]",
        "heapq.heappush(self.h, VALUE)",
        "value = heapq.heappop(self.h)",
        "clean = self.k[0]",
    ),
    "generator": (
        "self.gen = averaged()\nnext(self.gen)\nself.k = 0.0",
        "self.out = self.gen.send(VALUE)",
        "value = self.out",
        "clean = self.k",
    ),
    "callable": (
        "self.filt = Filter()\nself.filt2 = Filter()",
        "self.filt(VALUE)",
        "value = self.filt.y",
        "clean = self.filt2.y",
    ),
    "own items": (
        "self.d = Table()\nself.e = Table()",
        'self.d["a"] = VALUE',
        'value = self.d["a"]',
        'clean = self.e["a"]',
    ),
    "items by special names": (
        'self.d = {}\nself.e = {"a": 1.0}',
        'self.d.__setitem__("a", VALUE)',
        'value = self.d.__getitem__("a")',
        'clean = self.e.__getitem__("a")',
    ),
    "vars": ("self.x = 0.0\nself.y = 1.0", 'vars(self)["x"] = VALUE', "value = self.x", "clean = self.y"),
    "enumeration keys": (
        "self.d = {Side.LEFT: 0.0, Side.RIGHT: 1.0}",
        "self.d[Side.LEFT] = VALUE",
        "value = self.d[Side.LEFT]",
        "clean = self.d[Side.RIGHT]",
    ),
    "key out of two": (
        'self.d = {"a": 0.0, "b": 0.0, "c": 1.0}\nself.n = 0',
        'self.d["a" if self.n else "b"] = VALUE',
        'value = self.d["b"]',
        'clean = self.d["c"]',
    ),
    "taken with a tuple": (
        "self.d = Data()",
        "self.d.a = VALUE",
        "value = astuple(self.d)[0]",
        "clean = astuple(self.d)[1]",
    ),
    "taken with a getter": (
        "self.d = Data()",
        "self.d.a = VALUE",
        'value = attrgetter("a")(self.d)',
        'clean = attrgetter("b")(self.d)',
    ),
    "rows turned round": (
        "self.rows = [(0.0, 1.0)]",
        "self.rows = [(VALUE, 1.0), (VALUE, 2.0)]",
        "value = list(zip(*self.rows))[0]",
        "clean = list(zip(*self.rows))[1]",
    ),
    "context manager": (
        "self.s = Store()\nself.t = Store()",
        "with self.s as held:\n    held.x = VALUE",
        "value = self.s.x",
        "clean = self.t.x",
    ),
    "match": (
        "self.x = 0.0\nself.y = 1.0",
        "match [VALUE, 1.0]:\n    case [v, 1.0]:\n        self.x = v",
        "value = self.x",
        "clean = self.y",
    ),
    "comprehension": (
        "self.l = []\nself.k = [1.0]",
        "self.l = [2 * v for v in (VALUE, 0.0)]",
        "value = max(self.l)",
        "clean = max(self.k)",
    ),
    "sorted": (
        "self.l = []\nself.k = [1.0]",
        "self.l = sorted([*self.l, VALUE])",
        "value = self.l[0]",
        "clean = sorted(self.k)[0]",
    ),
    "object of a library": (
        "self.kf = cv2.KalmanFilter(2, 1)\nself.kf2 = cv2.KalmanFilter(2, 1)",
        "self.kf.correct(VALUE)",
        "value = self.kf.predict()",
        "clean = self.kf2.predict()",
    ),
    "array of a message": (
        "self.a = Float64MultiArray()\nself.b = Float64MultiArray()",
        "self.a.data.append(VALUE)",
        "value = self.a.data[0]",
        "clean = len(self.a.data) + sum(self.b.data)",
    ),
    "walrus store": (
        "self.x = 0.0\nself.y = 0.0",
        "if (v := VALUE) is not None:\n    self.x = v",
        "value = self.x",
        "clean = self.y",
    ),
}

CALLBACKS: Final[Mapping[str, str]] = {
    "method": 'rospy.Subscriber("in", Float64, self.on)',
    "lambda": 'rospy.Subscriber("in", Float64, lambda m: self.on(m))',
    "partial": 'rospy.Subscriber("in", Float64, functools.partial(self.on))',
    "nested": 'def inner(m):\n    self.on(m)\nrospy.Subscriber("in", Float64, inner)',
    "bound by name": 'cb = getattr(self, "on")\nrospy.Subscriber("in", Float64, cb)',
    "dict entry": 'table = {"in": self.on, "none": None}\nrospy.Subscriber("in", Float64, table["in"])',
    "callable object": 'rospy.Subscriber("in", Float64, Caller(self.on))',
    "helper": "self.listen(self.on)",
    "loop": 'for t, cb in [("in", self.on)]:\n    rospy.Subscriber(t, Float64, cb)',
    "decorated": 'rospy.Subscriber("in", Float64, logged(self.on))',
    "base class": "super().__init__()",
}

# Code that publishes `value`, and code that publishes `clean`.
MESSAGES: Final[Mapping[str, tuple[str, str]]] = {
    "scalar": ("OUT.publish(value)", "OUT.publish(clean)"),
    "constructor": ("OUT.publish(Float64(data=value))", "OUT.publish(Float64(data=clean))"),
    "positional": ("OUT.publish(Float64(value))", "OUT.publish(Float64(clean))"),
    "flat store": (
        "m = Float64()\nm.data = value\nOUT.publish(m)",
        "m = Float64()\nm.data = clean\nOUT.publish(m)",
    ),
    "nested store": (
        "t = Twist()\nt.linear.x = value\nt.angular.z = 1.0\nOUT.publish(t)",
        "t = Twist()\nt.linear.x = clean\nOUT.publish(t)",
    ),
    "alias store": (
        "t = Twist()\nlin = t.linear\nlin.x = value\nOUT.publish(t)",
        "t = Twist()\nlin = t.linear\nlin.x = value\nlin.x = clean\nOUT.publish(t)",
    ),
    "kept message": (
        "self.msg.linear.x = value\nself.msg.linear.y = 0.0\nOUT.publish(self.msg)",
        "self.msg.linear.x = clean\nself.msg.linear.y = 0.0\nOUT.publish(self.msg)",
    ),
    "array": (
        "a = Float64MultiArray()\na.data.append(value)\nOUT.publish(a)",
        "a = Float64MultiArray()\na.data.append(clean)\nOUT.publish(a)",
    ),
    "array list": (
        "OUT.publish(Float64MultiArray(data=[0.0, value]))",
        "OUT.publish(Float64MultiArray(data=[0.0, clean]))",
    ),
    "kwargs": ('OUT.publish(Float64(**{"data": value}))', 'OUT.publish(Float64(**{"data": clean}))'),
    "deepcopy": (
        "t = copy.deepcopy(self.msg)\nt.linear.x = value\nOUT.publish(t)",
        "t = copy.deepcopy(self.msg)\nt.linear.x = clean\nOUT.publish(t)",
    ),
    "helper made": ("OUT.publish(build(value))", "OUT.publish(build(clean))"),
    "text": ('OUT.publish(String(data=f"v={value:.2f}"))', 'OUT.publish(String(data=f"v={clean:.2f}"))'),
    "format": ('OUT.publish("v={0}".format(value))', 'OUT.publish("v={0}".format(clean))'),
    "json": ('OUT.publish(json.dumps({"v": value}))', 'OUT.publish(json.dumps({"v": clean}))'),
    "conditional": ("OUT.publish(value if value > 0 else 0.0)", "OUT.publish(clean if clean > 0 else 0.0)"),
    "comprehension": (
        "OUT.publish([2 * v for v in (value, 1.0)])",
        "OUT.publish([2 * v for v in (clean, 1.0)])",
    ),
    "setter helper": (
        "t = Twist()\nfill(t, value)\nOUT.publish(t)",
        "t = Twist()\nfill(t, clean)\nOUT.publish(t)",
    ),
    "setattr field": (
        't = Twist()\nsetattr(t.linear, "x", value)\nOUT.publish(t)',
        't = Twist()\nsetattr(t.linear, "x", clean)\nOUT.publish(t)',
    ),
    "star": ("OUT.publish(*[value])", "OUT.publish(*[clean])"),
}

# Code that creates a publisher, and the expression for it.
PUBLISHERS: Final[Mapping[str, tuple[str, str]]] = {
    "attribute": ('self.pub = rospy.Publisher("out", Float64, queue_size=1)', "self.pub"),
    "dict": ('self.pubs = {"o": rospy.Publisher("out", Float64, queue_size=1)}', 'self.pubs["o"]'),
    "list": ('self.pubs = [rospy.Publisher("out", Float64, queue_size=1)]', "self.pubs[0]"),
    "object": ("self.link = Link()", "self.link.pub"),
    "global": ("pass", "g_pub"),
    "returned": ("pass", "publisher()"),
}

RUNNERS: Final[Mapping[str, str]] = {
    "timer": """\
    def tick(self, event):
BODY""",
    "loop": """\
    def spin(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
BODY
            rate.sleep()""",
    "try": """\
    def tick(self, event):
        try:
BODY
        except ValueError:
            pass
        finally:
            self.ended = True""",
    "called": """\
    def tick(self, event):
        self.work()

    def work(self):
BODY""",
    "thread": """\
    def runner(self):
        while True:
BODY
            time.sleep(0.1)""",
    "async": """\
    def tick(self, event):
        asyncio.run(self.work())

    async def work(self):
BODY""",
}

HEAD: Final = """import asyncio, copy, functools, heapq, json, queue, threading, time
from collections import defaultdict, deque, namedtuple
from concurrent.futures import Future
from dataclasses import astuple, dataclass, replace
from enum import Enum
from operator import attrgetter
import cv2
import numpy as np
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, Float64MultiArray, String
Pair = namedtuple("Pair", "a b")
g_x = 0.0
g_y = 1.0
g_list = [0.0, 1.0]


class Store:
    def __init__(self):
        self.x = 0.0
        self.y = 1.0

    def set(self, v):
        self.x = v

    def get(self):
        return self.x


    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None


class Side(Enum):
    LEFT = 1
    RIGHT = 2


class Table:
    def __init__(self):
        self.entries = {"a": 0.0}

    def __getitem__(self, key):
        return self.entries[key]

    def __setitem__(self, key, entry):
        self.entries[key] = entry


class Filter:
    def __init__(self):
        self.y = 0.0

    def __call__(self, v):
        self.y = 0.5 * self.y + v
        return self.y


class Caller:
    def __init__(self, f):
        self.f = f

    def __call__(self, m):
        return self.f(m)


class Link:
    def __init__(self):
        self.pub = rospy.Publisher("out", Float64, queue_size=1)


@dataclass
class Data:
    a: float = 0.0
    b: float = 1.0


def cell():
    kept = 0.0

    def keep(v):
        nonlocal kept
        kept = v

    def give():
        return kept

    return keep, give


def averaged():
    total = 0.0
    while True:
        v = yield total
        total += v


def build(v):
    m = Float64()
    m.data = v
    return m


def fill(t, v):
    t.linear.x = v


def logged(f):
    @functools.wraps(f)
    def inner(*args, **kwargs):
        return f(*args, **kwargs)
    return inner


def publisher():
    return g_pub


g_store = Store()
g_pub = rospy.Publisher("out", Float64, queue_size=1)


class Base:
    def __init__(self):
HOOK

    def listen(self, callback):
        rospy.Subscriber("in", Float64, callback)


class Node(Base):
    shared = 0.0
    fixed = 1.0
    history = []

"""
PROPERTY: Final = """    @property
    def prop(self):
        return self._p

    @prop.setter
    def prop(self, v):
        self._p = v"""
FOOT: Final = """


rospy.init_node("n")
node = Node()
"""
TIMER: Final = "rospy.Timer(rospy.Duration(0.1), self.tick)"
STARTS: Final = {
    **dict.fromkeys(RUNNERS, TIMER),
    "loop": "pass",
    "thread": "threading.Thread(target=self.runner).start()",
}
DEPTH: Final = {**dict.fromkeys(RUNNERS, 8), "loop": 12, "try": 12, "thread": 12}
AXES: Final = (STATES, CALLBACKS, MESSAGES, PUBLISHERS, RUNNERS)


def node(state: str, callback: str, message: str, publisher: str, runner: str) -> str:
    """Return the text of a node composed of these parts."""
    start, store, read, clean = STATES[state]
    make, name = PUBLISHERS[publisher]
    send, send_clean = (text.replace("OUT", name) for text in MESSAGES[message])
    first, second = ([clean, f"{send_clean}  # clean"], [read, f"{send}  # sink"])
    body = (
        [clean, read, f"{send_clean}  # clean", f"{send}  # sink"]
        if "value" in send_clean
        else [*first, *second]
    )
    init = [start, "self.msg = Twist()", make, CALLBACKS[callback], STARTS[runner]]
    parts = (
        ("    def __init__(self):", init),
        (PROPERTY, []),
        ("    def on(self, msg):", [store.replace("VALUE", "msg.data")]),
        (RUNNERS[runner].replace("BODY", indent("\n".join(body), " " * DEPTH[runner])), []),
    )
    methods = [head + "\n" + indent("\n".join(lines), " " * 8) for head, lines in parts]
    hook = "        rospy.Subscriber('in', Float64, self.on)" if callback == "base class" else "        pass"
    return (
        HEAD.replace("HOOK", hook)
        + "\n\n".join(methods)
        + FOOT
        + ("node.spin()\n" if runner == "loop" else "")
    )
