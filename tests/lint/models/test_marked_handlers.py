"""Handlers marked by a decorator and collected from their class each receive their own topic."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

NODE = """\
import functools, inspect
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
def listens(topic):
    def mark(method):
        MARK
        return method
    return mark
class Base(Node):
    _ports = []
CLASS
    def __init__(self):
        super().__init__("node")
LOOP
class Pair(Base):
    def __init__(self):
        super().__init__()
        self.a = self.create_publisher(String, "a", 1)
        self.b = self.create_publisher(String, "b", 1)
    @listens("near")
    def on_near(self, msg):
        self.a.publish(msg)  # near:data
    def other(self, msg):
        self.a.publish(msg)  # clean
    @listens("far")
    def on_far(self, msg):
        self.b.publish(msg)  # far:data
rclpy.init()
rclpy.spin(Pair())
"""
HOOK = """\
    def __init_subclass__(cls, **kwargs):
        super().__init_subclass__(**kwargs)
"""
BY_NAME = """\
        for name, topic in self._ports:
            self.create_subscription(String, topic, getattr(self, name), 1)
"""
# what collects the marked methods; after `---`, the loop that subscribes, if it is not BY_NAME
COLLECTED = """\
### a comprehension that asks whether there is a mark
cls._ports = [(name, f.__port__) for name, f in vars(cls).items() if hasattr(f, "__port__")]
### a comprehension that gets the mark
cls._ports = tuple((name, f.__port__) for name, f in cls.__dict__.items() if getattr(f, "__port__", None))
### a comprehension that assigns the mark
cls._ports = [(n, t) for n, f in vars(cls).items() if (t := getattr(f, "__port__", None)) is not None]
### a sorted comprehension
cls._ports = sorted((name, f.__port__) for name, f in vars(cls).items() if hasattr(f, "__port__"))
### a loop that appends
cls._ports = []
for name, f in vars(cls).items():
    if hasattr(f, "__port__"):
        cls._ports.append((name, f.__port__))
### a mapping of topics
cls._ports = {f.__port__: name for name, f in vars(cls).items() if hasattr(f, "__port__")}
---
for topic, name in self._ports.items():
    self.create_subscription(String, topic, getattr(self, name), 1)
### only the names
cls._ports = [name for name, f in vars(cls).items() if hasattr(f, "__port__")]
---
for name in self._ports:
    handler = getattr(self, name)
    self.create_subscription(String, handler.__port__, handler, 1)
### only the functions
cls._ports = [f for f in vars(cls).values() if hasattr(f, "__port__")]
---
for f in self._ports:
    self.create_subscription(String, f.__port__, f.__get__(self), 1)
### the functions, and partials
cls._ports = [f for f in vars(cls).values() if hasattr(f, "__port__")]
---
for f in self._ports:
    self.create_subscription(String, f.__port__, functools.partial(f, self), 1)
### members of the node
pass
---
for _, f in inspect.getmembers(self, inspect.ismethod):
    if hasattr(f, "__port__"):
        self.create_subscription(String, f.__port__, f, 1)
"""
CASES = sections(COLLECTED)
MARKS = ["method.__port__ = topic", 'setattr(method, "__port__", topic)']


def indented(text: str) -> str:
    return "".join(f"        {line}\n" for line in text.splitlines())


@pytest.mark.parametrize("mark", MARKS)
@pytest.mark.parametrize("title", CASES)
def test_each_marked_handler_receives_only_its_topic(title, mark):
    collect, _, subscribe = CASES[title].partition("---\n")
    text = NODE.replace("MARK", mark).replace("CLASS", HOOK + indented(collect))
    assert differing_topics(text.replace("LOOP", indented(subscribe) or BY_NAME)) == {}
