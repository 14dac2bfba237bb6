"""Code that runs in another order than it is written: context managers from generators, servers, executors."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import asyncio, contextlib, rospy, threading
from contextlib import asynccontextmanager, contextmanager
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# Programs, each below its title.
PROGRAMS = """\
### code after the yield of a context manager runs after the body
class Node:
    def __init__(self):
        self.last = None
        rospy.Subscriber("in", Float64, self.on)
    @contextmanager
    def holding(self, value):
        self.last = value
        yield
        self.last = None
    def on(self, msg):
        with self.holding(msg.data):
            out.publish(self.last)  # data
        out.publish(self.last)  # clean
Node()
### finally after a yield
state = {}
@contextlib.contextmanager
def holding(value):
    state["x"] = value
    try:
        yield state
    finally:
        state["x"] = 0.0
def on(msg):
    with holding(msg.data) as s:
        out.publish(s["x"])  # data
        out.publish(state["x"])  # data
    out.publish(state["x"])  # clean
rospy.Subscriber("in", Float64, on)
### what the body stores is read after the yield
class Tape:
    def __init__(self):
        self.total = 0.0
tape = Tape()
@contextmanager
def summing():
    tape.total = 0.0
    local = 2.0
    try:
        yield tape
    except ValueError:
        out.publish(0.0)  # clean
    else:
        local = local + 1.0
    finally:
        out.publish(tape.total * local)  # data
        tape.total = 0.0
def on(msg):
    with summing() as t:
        t.total += msg.data
    out.publish(tape.total)  # clean
rospy.Subscriber("in", Float64, on)
### lock around a yield
lock = threading.Lock()
shared = {"v": 0.0}
@contextmanager
def locked():
    with lock:
        before = shared["v"]
        yield shared
        shared["v"] = before
def on(msg):
    with locked() as s:
        s["v"] = msg.data
        out.publish(s["v"])  # data
    out.publish(shared["v"])  # clean
rospy.Subscriber("in", Float64, on)
### two managers, inner leaves first
log = []
class S: pass
s = S()
@contextmanager
def outer():
    s.a = 1.0
    yield
    out.publish(s.b)  # clean
@contextmanager
def inner(x):
    s.b = x
    yield
    out.publish(s.b)  # data
    s.b = 0.0
def on(msg):
    with outer(), inner(msg.data):
        pass
rospy.Subscriber("in", Float64, on)
### async manager
class Node:
    def __init__(self):
        self.v = 0.0
    @asynccontextmanager
    async def speed(self, v):
        old, self.v = self.v, v
        yield
        self.v = old
    async def on(self, msg):
        async with self.speed(msg.data):
            out.publish(self.v)  # data
        out.publish(self.v)  # clean
n = Node()
rospy.Subscriber("in", Float64, n.on)
### yield in a branch stays a generator
@contextmanager
def chosen(v):
    if v > 1.0:
        yield v
    else:
        yield 0.0
def on(msg):
    with chosen(msg.data) as v:
        out.publish(v)  # data
rospy.Subscriber("in", Float64, on)
### an exit stack
class Node:
    v = 0.0
n = Node()
@contextmanager
def speed(v):
    n.v = v
    yield n
    n.v = 0.0
def on(msg):
    with contextlib.ExitStack() as stack:
        m = stack.enter_context(speed(msg.data))
        out.publish(m.v)  # data
    out.publish(n.v)  # clean
rospy.Subscriber("in", Float64, on)
### lifespan of a web server
from fastapi import FastAPI
state = {}
class Node:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
@asynccontextmanager
async def lifespan(app):
    state["node"] = Node()
    yield
    state.clear()
app = FastAPI(lifespan=lifespan)
@app.get("/")
async def get():
    out.publish(state["node"].v)  # data
### plain async generator as lifespan
from starlette import App
state = {}
class Node:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
async def lifespan(app):
    state["node"] = Node()
    yield
    state["node"] = None
app = App(lifespan=lifespan)
@app.get("/")
async def get():
    out.publish(state["node"].v)  # data
### a node that a function of an executor makes
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
def start():
    return Side()
async def main():
    loop = asyncio.get_running_loop()
    n = await loop.run_in_executor(None, start)
    while True:
        rospy.sleep(1.0)
        n.drive()
asyncio.run(main())
### a node made in a thread that a coroutine starts in an executor
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
class RosThread:
    def __init__(self, factory):
        self._factory = factory
        self.node = None
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._run)
    def start(self):
        self._thread.start()
        self._ready.wait()
        return self.node
    def _run(self):
        self.node = self._factory()
async def main():
    loop = asyncio.get_running_loop()
    t = RosThread(lambda: Side())
    n = await loop.run_in_executor(None, t.start)
    while True:
        rospy.sleep(1.0)
        n.drive()
asyncio.run(main())
### a node that a thread makes while a coroutine waits
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
def start():
    return Side()
async def main():
    n = await asyncio.to_thread(start)
    while True:
        rospy.sleep(1.0)
        n.drive()
asyncio.run(main())
### the result of a function submitted to a pool
from concurrent.futures import ThreadPoolExecutor
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
pool = ThreadPoolExecutor()
n = pool.submit(lambda: Side()).result()
while True:
    rospy.sleep(1.0)
    n.drive()
### a node that a task makes
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
async def make():
    return Side()
async def main():
    task = asyncio.create_task(make())
    n = await task
    while True:
        rospy.sleep(1.0)
        n.drive()
asyncio.run(main())
### a node that one of several coroutines makes
class Side:
    def __init__(self):
        self.v = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.v = msg.data
    def drive(self):
        out.publish(self.v)  # data
async def make():
    return Side()
async def other():
    return 1.0
async def main():
    n, _ = await asyncio.gather(make(), other())
    while True:
        rospy.sleep(1.0)
        n.drive()
asyncio.run(main())
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_flows_follow_the_order_of_execution(title):
    assert differing(HEAD + CASES[title]) == {}
