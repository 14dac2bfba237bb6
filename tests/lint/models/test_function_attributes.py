"""Attributes that decorators, or statements after the `def`, set on functions are found on bound methods."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, flows

HEAD = """\
import functools, rclpy, library
from rclpy.node import Node
from std_msgs.msg import Float64

def topic(name, kind=Float64):
    def mark(function):
        function._topic = name
        function._kind = kind
        return function
    return mark

"""
# Programs, each below its title, with the topics of the subscriptions.
PROGRAMS = """\
### read from the bound method: a
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(self.f._kind, self.f._topic, self.f, 1)
    @topic("a")
    def f(self, msg):
        self.out.publish(msg)  # data
### getattr with and without a default: a b
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, getattr(self.f, "_topic"), self.f, 1)
        self.create_subscription(Float64, getattr(self.g, "_topic", None), self.g, 1)
    @topic("a")
    def f(self, msg):
        self.out.publish(msg)  # data
    @topic("b")
    def g(self, msg):
        self.out.publish(msg)  # data
### a test of the attribute: a
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        if getattr(self.f, "_topic", None):
            self.create_subscription(Float64, self.f._topic, self.f, 1)
        if getattr(self.g, "_topic", None):
            self.create_subscription(Float64, self.g._topic, self.g, 1)
    @topic("a")
    def f(self, msg):
        self.out.publish(msg)  # data
    def g(self, msg):
        self.out.publish(msg)  # clean
### set after the def, in the class and after it: a b
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, self.f._topic, self.f, 1)
        if hasattr(self.g, "_topic"):
            self.create_subscription(Float64, self.g._topic, self.g, 1)
    def f(self, msg):
        self.out.publish(msg)  # data
    f._topic = "a"
    def g(self, msg):
        self.out.publish(msg)  # data
N.g._topic = "b"
### a wrapper made with functools.wraps shows the attributes of its function: a
def quick(function):
    @functools.wraps(function)
    def wrapper(self, msg):
        return function(self, msg)
    return wrapper
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        if getattr(self.f, "_topic", None) is not None:
            self.create_subscription(Float64, self.f._topic, self.f, 1)
    @quick
    @topic("a")
    def f(self, msg):
        self.out.publish(msg)  # data
### update_wrapper, and an attribute of the wrapper itself: b c
def quick(function):
    def wrapper(self, msg):
        return function(self, msg)
    functools.update_wrapper(wrapper, function)
    wrapper._other = "c"
    return wrapper
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, self.f._topic, self.f, 1)
        self.create_subscription(Float64, self.f._other, self.f, 1)
    @quick
    @topic("b")
    def f(self, msg):
        self.out.publish(msg)  # data
### a wrapper without functools.wraps has no such attribute:
def quick(function):
    def wrapper(self, msg):
        return function(self, msg)
    return wrapper
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        if getattr(self.f, "_topic", None):
            self.create_subscription(Float64, self.f._topic, self.f, 1)
    @quick
    @topic("a")
    def f(self, msg):
        self.out.publish(msg)  # clean
### a decorator of a library may set the attribute:
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        if getattr(self.f, "_topic", None):
            self.create_subscription(Float64, self.f._topic, self.f, 1)
    @library.topic("a")
    def f(self, msg):
        self.out.publish(msg)  # data
### the standard library adds no attribute:
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        if getattr(self.f, "_topic", None):
            self.create_subscription(Float64, self.f._topic, self.f, 1)
    @functools.lru_cache()
    def f(self, msg):
        self.out.publish(msg)  # clean
### a partial function may have any attribute:
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        f = functools.partial(self.f, 1)
        if getattr(f, "_topic", None):
            self.create_subscription(Float64, f._topic, f, 1)
    def f(self, number, msg):
        self.out.publish(msg)  # data
### the name of a method, its function and its object: f data
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, self.f.__name__, self.f, 1)
        self.create_subscription(Float64, self.f.__func__._topic, lambda m: self.g.__self__.f(m), 1)
    def f(self, msg):
        self.out.publish(msg)  # data
    f._topic = "data"
    def g(self, msg):
        pass
### different methods have different attributes: a
class N(Node):
    def __init__(self):
        self.out = self.create_publisher(Float64, "out", 1)
        for method in (self.f, self.g):
            self.create_subscription(Float64, method._topic, method, 1)
    @topic("a")
    def f(self, msg):
        self.out.publish(msg.data)  # data
    @topic("b")
    def g(self, msg):
        self.out.publish(1.0)  # clean
"""
CASES = {
    title: (HEAD + body + "rclpy.spin(N())\n", set(title.partition(": ")[2].split()))
    for title, _, body in (part.partition("\n") for part in PROGRAMS.split("### ")[1:])
}


@pytest.mark.parametrize("title", CASES)
def test_attributes_of_functions_are_found_on_bound_methods(title: str) -> None:
    text, topics = CASES[title]
    found = flows(text)
    assert differing(text, found) == {}
    assert {name for flow in found for name in flow.source.topics} == (topics if found else set())
