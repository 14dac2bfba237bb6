"""Styles of small packages around ROS: the flows of each program are marked on its publish calls."""

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
### a constant that a condition replaces by zero
def on(msg):
    command = Float64()
    command.data = 1.0
    if msg.data > 5.0:
        command.data = 0.0
    out.publish(command)  # control
rospy.Subscriber("in", Float64, on)
### a field that a condition sets to its default
def on(msg):
    command = Float64()
    if msg.data > 5.0:
        command.data = 0.0
    out.publish(command)  # clean
rospy.Subscriber("in", Float64, on)
### a generic base class with parameters
class Relay(Generic[I, O]):
    topic, other = "in", "out"
    def __init__(self):
        self.node = rclpy.create_node("relay")
        self.pub = self.node.create_publisher(Float64, self.other, 1)
        self.node.create_subscription(Float64, self.topic, self.receive, 1)
    def receive(self, msg):
        self.pub.publish(self.change(msg))  # data
class Same(Relay[Float64, Float64]):
    def change(self, msg):
        return msg
Same()
### an enumeration is not a generic class
class Level(enum.Enum):
    LOW, HIGH = 0.0, 1.0
rospy.Subscriber("in", Float64, lambda msg: out.publish(Level[msg.data].value))  # data
### public methods of a class that nothing makes
class Robot:
    def __init__(self):
        self.pub = rospy.Publisher("vel", Float64, queue_size=1)
        self.seen = 0.0
        rospy.Subscriber("in", Float64, self.receive)
    def receive(self, msg):
        self.seen = msg.data
    def drive(self, speed):
        self.pub.publish(speed)  # clean
    def follow(self):
        self.pub.publish(self.seen)  # data
### operators of streams
class Stream:
    def __init__(self, start):
        self.start = start
    def subscribe(self, receive):
        return self.start(receive)
    def map(self, change):
        return Stream(lambda receive: self.subscribe(lambda x: receive(change(x))))
    def filter(self, keeps):
        def start(receive):
            def inner(x):
                if keeps(x):
                    receive(x)
            return self.subscribe(inner)
        return Stream(start)
stream = Stream(lambda receive: rospy.Subscriber("in", Float64, receive))
stream.filter(lambda m: m.data > 0).map(lambda m: m.data).subscribe(lambda x: out.publish(x))  # data
stream.filter(lambda m: m.data > 0).map(lambda m: 1.0).subscribe(lambda x: out.publish(x))  # control
### a tree whose parts have the same method
class Group:
    def __init__(self, *parts):
        self.parts = parts
    def tick(self):
        for part in self.parts:
            part.tick()
class Say:
    def tick(self):
        out.publish(seen[0])  # data
seen = [0.0]
rospy.Subscriber("in", Float64, lambda msg: seen.__setitem__(0, msg.data))
tree = Group(Group(Group(Group(Say()))))
while not rospy.is_shutdown():
    tree.tick()
### an iterator that waits for messages
class Messages:
    def __init__(self):
        self.queue = queue.Queue()
        rospy.Subscriber("in", Float64, self.queue.put)
    def __iter__(self):
        return self
    def __next__(self):
        return self.queue.get()
def main():
    for msg in Messages():
        out.publish(msg)  # data
main()
### an asynchronous iterator
class Messages:
    def __init__(self):
        self.queue = asyncio.Queue()
        rospy.Subscriber("in", Float64, self.queue.put_nowait)
    def __aiter__(self):
        return self
    async def __anext__(self):
        return await self.queue.get()
async def main():
    async for msg in Messages():
        out.publish(msg)  # data
asyncio.run(main())
### a loop whose body first publishes and then waits
class Box:
    def __init__(self):
        self.last = 0.0
        rospy.Subscriber("in", Float64, self.receive)
    def receive(self, msg):
        self.last = msg.data
def main():
    box = Box()
    for _ in range(10):
        out.publish(box.last)  # data
        rospy.sleep(1)
main()
### a generator as context manager
@contextlib.contextmanager
def messages():
    box = []
    sub = rospy.Subscriber("in", Float64, box.append)
    yield box
    sub.unregister()
with messages() as box:
    rospy.sleep(1)
    out.publish(sum(m.data for m in box))  # data
### a context manager that publishes when a return leaves its body
class Say:
    def __enter__(self):
        return self
    def __exit__(self, *error):
        out.publish(self.value)  # data
def on(msg):
    with Say() as say:
        say.value = msg.data
        return
rospy.Subscriber("in", Float64, on)
### an asynchronous context manager
class Say:
    async def __aenter__(self):
        return self
    async def __aexit__(self, *error):
        out.publish(self.value)  # data
async def on(msg):
    async with Say() as say:
        say.value = msg.data
rospy.Subscriber("in", Float64, on)
### topics as descriptors
class Topic:
    def __init__(self, name):
        self.value = 0.0
        self.pub = rospy.Publisher(name, Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.receive)
    def receive(self, msg):
        self.value = msg.data
    def __get__(self, obj, owner=None):
        return self.value
    def __set__(self, obj, value):
        self.pub.publish(value)  # data
class Head:
    pan = Topic("pan")
head = Head()
while not rospy.is_shutdown():
    head.pan = head.pan + 1.0
    rospy.sleep(1)
### topics as attributes of a proxy
class Topics:
    def __init__(self):
        object.__setattr__(self, "seen", {})
        rospy.Subscriber("in", Float64, self.receive)
    def receive(self, msg):
        self.seen["x"] = msg.data
    def __getattr__(self, name):
        return self.seen[name]
    def __setattr__(self, name, value):
        rospy.Publisher(name, Float64).publish(value)  # data
topics = Topics()
while not rospy.is_shutdown():
    topics.y = topics.x
### attributes that `super` sets
class Checked:
    def __setattr__(self, name, value):
        super().__setattr__(name, value)
kept = Checked()
def on(msg):
    kept.near, kept.far = msg.data, 1.0
    out.publish(kept.near)  # data
    out.publish(kept.far)  # clean
rospy.Subscriber("in", Float64, on)
### implementations of a generic function
@functools.singledispatch
def say(msg):
    out.publish(0.0)  # clean
@say.register
def _(msg: Float64):
    out.publish(msg.data)  # data
rospy.Subscriber("in", Float64, say)
### a handler that a server makes
class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        self.server.pub.publish(seen[0])  # data
class Server(http.server.HTTPServer):
    def __init__(self):
        super().__init__(("", 80), Handler)
        self.pub = rospy.Publisher("pub", Float64, queue_size=1)
seen = [0.0]
rospy.Subscriber("in", Float64, lambda msg: seen.__setitem__(0, msg.data))
Server().serve_forever()
### observers of a library's object
subject = reactivex.Subject()
subject.pipe(1).subscribe(lambda x: out.publish(x))  # data
rospy.Subscriber("in", Float64, subject.on_next)
other = reactivex.Subject()
other.pipe(1).subscribe(lambda x: out.publish(x))  # clean
rospy.Subscriber("other", Float64, print)
### functions in a list that a library gets
def say(text):
    out.publish(seen["x"])  # data
seen = {}
rospy.Subscriber("in", Float64, lambda msg: seen.update(x=msg.data))
agent = agents.make([say])
### a program that ends with the exit code of a window
class Window:
    def __init__(self):
        self.seen = 0.0
        rospy.Subscriber("in", Float64, self.receive)
        rospy.Timer(rospy.Duration(1), self.tick)
    def receive(self, msg):
        self.seen = msg.data
    def tick(self, event):
        out.publish(self.seen)  # data
if __name__ == "__main__":
    window = Window()
    sys.exit(app.exec_())
### setattr and getattr of a property
class Level:
    def __init__(self):
        self.seen = []
    @property
    def value(self):
        return self.seen[-1]
    @value.setter
    def value(self, value):
        self.seen.append(value)
        out.publish(value)  # data
level = Level()
rospy.Subscriber("in", Float64, lambda msg: setattr(level, "value", msg.data))
rospy.Timer(1, lambda event: out.publish(getattr(level, "value")))  # data
### an object as text by a method of a library's base class
class Fix(pydantic.BaseModel):
    lat: float
    other: float
def on(msg):
    fix = Fix(lat=msg.data, other=1.0)
    out.publish(fix.model_dump_json())  # data
    out.publish(fix.other)  # clean
    out.publish(fix.name())  # clean
rospy.Subscriber("in", Float64, on)
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])
MODULES = (
    "asyncio",
    "contextlib",
    "enum",
    "functools",
    "http.server",
    "pydantic",
    "queue",
    "rclpy",
    "reactivex",
    "sys",
)


@pytest.mark.parametrize("title", CASES)
def test_flows_are_found_in_styles_of_small_packages(title):
    imports = "".join(f"import {name}\n" for name in MODULES) + "from typing import Generic\n"
    assert differing(f"{imports}{HEAD}{CASES[title]}") == {}
