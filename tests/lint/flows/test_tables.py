"""Loops over tables and marked methods: each row has its own topics, callbacks and objects."""

from __future__ import annotations

from textwrap import dedent, indent

import pytest

from tarl_lint.interpret.budget import MAX_ROWS
from tests.lint.models.marked import flows

HEAD = """\
import enum
import functools
import inspect
from collections import namedtuple
from dataclasses import dataclass
from functools import partial

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


def listens(topic):
    def mark(function):
        function.topic = topic
        return function

    return mark


TABLE = [("a", "on_a"), ("b", "on_b")]
"""
NODE = """
class Robot(Node):
    BY_TOPIC = {{"a": "on_a", "b": "on_b"}}

    def __init__(self):
        super().__init__("robot")
        self.x = self.create_publisher(Float64, "x", 10)
        self.y = self.create_publisher(Float64, "y", 10)
        self.number = 1
        self.names = ["left", "right"]
{wiring}

    def listen(self, topic, callback, kind=Float64):
        return self._subscribe(topic, callback, kind)

    def _subscribe(self, topic, callback, kind):
        return self.create_subscription(kind, topic, callback, 10)

    @listens("a")
    def on_a(self, msg):
        self.x.publish(msg)

    @listens("b")
    def on_b(self, msg):
        self.y.publish(msg)

    def on(self, name, msg):
        self.on_a(msg) if name == "a" else self.on_b(msg)

    def rows(self):
        yield "a", self.on_a
        yield "b", self.on_b

    @property
    def size(self):
        return len(self.names)


rclpy.init()
rclpy.spin(Robot())
"""


def node(wiring: str, head: str = "") -> str:
    body = indent(dedent(wiring).strip(), " " * 8)
    return f"{HEAD}{dedent(head)}{NODE.format(wiring=body)}"


def ends(text: str) -> set[tuple[str, str]]:
    """Return (topic of the source, topic of the sink) for each flow; `?` for an unknown topic."""
    return {(a, b) for f in flows(text) for a in f.source.topics or "?" for b in f.sink.topics or "?"}


APART = {("a", "x"), ("b", "y")}
EVERYTHING = {(a, b) for a in "ab" for b in "xy"}

WIRINGS = {
    "a helper, with methods": """
        for topic, callback in (("a", self.on_a), ("b", self.on_b)):
            self.listen(topic, callback)
    """,
    "a helper, with partials": """
        for name in ("a", "b"):
            self.listen(name, partial(self.on, name))
    """,
    "a helper, in a comprehension": """
        self.subs = [self.listen(t, getattr(self, name)) for t, name in TABLE]
    """,
    "a helper, in a comprehension with a condition": """
        self.subs = [self.listen(t, getattr(self, name)) for t, name in TABLE if name in self.names or t]
    """,
    "a helper, in a comprehension of a dictionary": """
        self.subs = {t: self.listen(t, getattr(self, name)) for t, name in self.BY_TOPIC.items()}
    """,
    "a lambda with a default": """
        for name in ["a", "b"]:
            self.create_subscription(Float64, name, lambda msg, name=name: self.on(name, msg), 10)
    """,
    "items": """
        for topic, name in self.BY_TOPIC.items():
            self.listen(topic, getattr(self, name))
    """,
    "sorted items": """
        for topic, name in sorted(self.BY_TOPIC.items()):
            self.listen(topic, getattr(self, name))
    """,
    "enumerated items": """
        for number, (topic, name) in enumerate(self.BY_TOPIC.items()):
            self.listen(topic, getattr(self, name))
    """,
    "keys": """
        for topic in self.BY_TOPIC:
            self.listen(topic, getattr(self, self.BY_TOPIC[topic]))
    """,
    "a set": """
        for topic in {"a", "b"}:
            self.listen(topic, partial(self.on, topic))
    """,
    "values of a nested table": """
        table = {"one": {"topic": "a", "then": self.on_a}, "two": {"topic": "b", "then": self.on_b}}
        for row in table.values():
            self.listen(row["topic"], row["then"])
    """,
    "a dictionary built step by step": """
        table = dict(a=self.on_a)
        table.update({"b": self.on_b})
        for topic in sorted(table):
            self.listen(topic, table[topic])
    """,
    "a list built step by step": """
        self.table = []
        self.table.append(("a", self.on_a))
        self.table.append(("b", self.on_b))
        for topic, callback in self.table:
            self.listen(topic, callback)
    """,
    "the sum of two lists": """
        for topic, name in TABLE[:1] + [("b", "on_b")]:
            self.listen(topic, getattr(self, name))
    """,
    "zip": """
        for topic, callback in zip(["a", "b"], [self.on_a, self.on_b]):
            self.listen(topic, callback)
    """,
    "enumerate from one": """
        for number, topic in enumerate(("a", "b"), start=1):
            self.listen(topic, lambda msg, number=number: self.on({1: "a", 2: "b"}[number], msg))
    """,
    "range over the length": """
        topics = ["a", "b"]
        for number in range(len(topics)):
            self.listen(topics[number], partial(self.on, topics[number]))
    """,
    "a generator": """
        for topic, callback in self.rows():
            self.listen(topic, callback)
    """,
    "named tuples": """
        Row = namedtuple("Row", "topic name")
        for row in (Row("a", "on_a"), Row("b", "on_b")):
            self.listen(row.topic, getattr(self, row.name))
    """,
    "an enumeration": """
        for one in Input:
            self.listen(one.value, lambda msg, one=one: self.on_a(msg) if one is Input.A else self.on_b(msg))
    """,
    "names of methods": """
        for topic in ("a", "b"):
            self.listen(topic, getattr(self, f"on_{topic}"))
    """,
    "a naming convention": """
        for name in dir(self):
            if name.startswith("on_"):
                self.listen(name[3:], getattr(self, name))
    """,
    "marks, with hasattr": """
        for name in dir(self):
            method = getattr(self, name)
            if hasattr(method, "topic"):
                self.listen(method.topic, method)
    """,
    "marks, with getattr and a default": """
        for name in dir(type(self)):
            topic = getattr(getattr(self, name), "topic", None)
            if topic is not None:
                self.listen(topic, getattr(self, name))
    """,
    "marks, with getmembers": """
        for name, method in inspect.getmembers(self, predicate=inspect.ismethod):
            if topic := getattr(method, "topic", ""):
                self.listen(topic, method)
    """,
    "marks, with getmembers and a lambda": """
        for _, method in inspect.getmembers(self, lambda one: hasattr(one, "topic")):
            self.listen(method.topic, method)
    """,
    "marks, in the body of the class": """
        for name, function in type(self).__dict__.items():
            if hasattr(function, "topic"):
                self.listen(function.topic, partial(function, self))
    """,
    "marks, in all base classes": """
        for cls in type(self).__mro__:
            for name, function in vars(cls).items():
                if hasattr(function, "topic"):
                    self.listen(function.topic, getattr(self, name))
    """,
}


@pytest.mark.parametrize("wiring", WIRINGS.values(), ids=WIRINGS)
def test_each_row_of_a_table_has_its_own_callback(wiring):
    assert ends(node(wiring, 'class Input(enum.Enum):\n    A = "a"\n    B = "b"\n')) == APART


REGISTRIES = {
    "a list of functions": ("HANDLERS.append((topic, function))", "HANDLERS = []", "HANDLERS", "partial(held, self)"),
    "names of functions": (
        "HANDLERS[topic] = function.__name__", "HANDLERS = {}", "HANDLERS.items()", "getattr(self, held)",
    ),
    "a class": (
        "Router.handlers.append((topic, function))", "class Router:\n    handlers = []", "Router.handlers",
        "lambda msg, held=held: held(self, msg)",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("store", "made", "table", "callback"), REGISTRIES.values(), ids=REGISTRIES)
def test_each_method_in_a_registry_has_its_own_topic(store, made, table, callback):
    head = f"{made}\ndef listens(topic):\n    def mark(function):\n        {store}\n        return function\n"
    head += "    return mark\n"
    assert ends(node(f"for topic, held in {table}:\n    self.listen(topic, {callback})", head)) == APART


MARKS = {
    "a list of several topics": """
        def listens(topic):
            def mark(function):
                function.__dict__.setdefault("topics", []).append(topic)
                return function
            return mark
    """,
    "a list that is made once": """
        def listens(topic):
            def mark(function):
                if not hasattr(function, "topics"):
                    function.topics = []
                function.topics.append(topic)
                return function
            return mark
    """,
    "a wrapper": """
        def listens(topic):
            def mark(function):
                @functools.wraps(function)
                def inner(*args):
                    return function(*args)
                inner.topics = [topic]
                return inner
            return mark
    """,
    "wrapped after the mark": """
        def listens(topic):
            def mark(function):
                function.topics = (topic,)
                @functools.wraps(function)
                def inner(*args):
                    return function(*args)
                return inner
            return mark
    """,
    "a class": """
        class listens:
            def __init__(self, topic):
                self.topic = topic
            def __call__(self, function):
                function.topics = (self.topic,)
                return function
    """,
}


@pytest.mark.parametrize("mark", MARKS.values(), ids=MARKS)
def test_the_marks_of_a_method_can_be_lists_wrappers_or_classes(mark):
    wiring = """
        for name in dir(type(self)):
            for topic in getattr(getattr(type(self), name), "topics", ()):
                self.listen(topic, getattr(self, name))
    """
    assert ends(node(wiring, mark)) == APART


PAIRS = {
    "publishers in a loop through a helper": """
        def __init__(self):
            super().__init__("n")
            self.outs = {}
            for name in NAMES:
                self.outs[name] = self.make(name + "/out")
                self.listen(name + "/in", partial(self.on, name))
        def on(self, name, msg):
            self.outs[name].publish(msg)
    """,
    "objects in a loop": """
        def __init__(self):
            super().__init__("n")
            self.channels = []
            for name in NAMES:
                self.channels.append(Channel(self, name + "/in", name + "/out"))
    """,
    "objects in a comprehension": """
        def __init__(self):
            super().__init__("n")
            self.channels = {name: Channel(self, name + "/in", name + "/out") for name in NAMES}
    """,
    "objects that are set up later": """
        def __init__(self):
            super().__init__("n")
            parts = []
            parts.append(Part("one"))
            parts.append(Part("two"))
            for part in parts:
                part.set_up(self)
    """,
    "rows of a data class": """
        def __init__(self):
            super().__init__("n")
            for row in [Row("one/in", "one/out"), Row("two/in", "two/out")]:
                self.connect(row)
        def connect(self, row):
            out = self.make(row.target)
            self.listen(row.source, lambda msg: out.publish(msg))
    """,
    "objects by name, without topics": """
        def __init__(self):
            super().__init__("n")
            self.filters = {}
            for name in NAMES:
                self.filters[name] = Filter()
            self.one, self.two = self.make("one/out"), self.make("two/out")
            self.listen("one/in", self.on_one)
            self.listen("two/in", self.on_two)
        def on_one(self, msg):
            self.one.publish(Float64(data=self.filters["one"].add(msg.data)))
        def on_two(self, msg):
            self.two.publish(Float64(data=self.filters["two"].add(msg.data)))
    """,
    "a loop that publishes for each entry": """
        def __init__(self):
            super().__init__("n")
            self.last, self.outs = {}, {}
            for name in NAMES:
                self.outs[name] = self.make(name + "/out")
                self.listen(name + "/in", partial(self.on, name))
            self.create_timer(0.1, self.tick)
        def on(self, name, msg):
            self.last[name] = msg.data
        def tick(self):
            for name, value in self.last.items():
                msg = Float64()
                msg.data = value
                self.outs[name].publish(msg)
    """,
    "a loop that publishes for each name": """
        def __init__(self):
            super().__init__("n")
            self.last = {name: None for name in NAMES}
            self.outs = {name: self.make(name + "/out") for name in NAMES}
            for name in NAMES:
                self.listen(name + "/in", partial(self.on, name))
            self.create_timer(0.1, self.tick)
        def on(self, name, msg):
            self.last[name] = msg.data
        def tick(self):
            for name in NAMES:
                if self.last[name] is None:
                    continue
                value = 2 * self.last[name]
                self.send(name, value)
        def send(self, name, value):
            self.outs[name].publish(Float64(data=value))
    """,
    "a loop that publishes for each number": """
        def __init__(self):
            super().__init__("n")
            self.last, self.outs = [0.0, 0.0], [self.make(name + "/out") for name in NAMES]
            self.listen("one/in", self.on_one)
            self.listen("two/in", self.on_two)
        def on_one(self, msg):
            self.last[0] = msg.data
            self.tick()
        def on_two(self, msg):
            self.last[1] = msg.data
            self.tick()
        def tick(self):
            for number in range(len(self.outs)):
                value = 2 * self.last[number]
                self.outs[number].publish(Float64(data=value))
    """,
    "a loop over objects that publishes for each": """
        def __init__(self):
            super().__init__("n")
            self.robots = {}
            for name in NAMES:
                self.robots[name] = Member(self, name)
            self.create_timer(0.1, self.tick)
        def tick(self):
            for robot in self.robots.values():
                if robot.last is not None:
                    value = 2 * robot.last
                    robot.pub.publish(Float64(data=value))
    """,
    "numbered topics": """
        def __init__(self):
            super().__init__("n")
            self.outs = [self.make(f"{name}/out") for name in NAMES]
            for number in range(2):
                self.listen(["one", "two"][number] + "/in", partial(self.on, number))
        def on(self, number, msg):
            self.outs[number].publish(msg)
    """,
}
PARTS = {
    "Row": """
        @dataclass
        class Row:
            source: str
            target: str
    """,
    "Channel": """
        class Channel:
            def __init__(self, node, source, target):
                self.last = 0.0
                self.pub = node.create_publisher(Float64, target, 10)
                node.create_subscription(Float64, source, self.on, 10)
            def on(self, msg):
                self.last = 0.5 * (self.last + msg.data)
                self.pub.publish(Float64(data=self.last))
    """,
    "Part": """
        class Part:
            def __init__(self, name):
                self.name = name
            def set_up(self, node):
                self.pub = node.create_publisher(Float64, self.name + "/out", 10)
                node.create_subscription(Float64, self.name + "/in", self.on, 10)
            def on(self, msg):
                self.pub.publish(msg)
    """,
    "Member": """
        class Member:
            def __init__(self, node, name):
                self.last = None
                self.pub = node.create_publisher(Float64, name + "/out", 10)
                node.create_subscription(Float64, name + "/in", self.on, 10)
            def on(self, msg):
                self.last = msg.data
    """,
    "Filter": """
        class Filter:
            def __init__(self):
                self.value = 0.0
            def add(self, value):
                self.value = 0.9 * self.value + 0.1 * value
                return self.value
    """,
}
ROBOT = """
NAMES = ["one", "two"]

class Base(Node):
    def make(self, topic):
        return self.create_publisher(Float64, topic, 10)
    def listen(self, topic, callback):
        self.create_subscription(Float64, topic, callback, 10)

class Robot(Base):
"""


@pytest.mark.parametrize("methods", PAIRS.values(), ids=PAIRS)
def test_each_row_of_a_table_has_its_own_publisher_and_state(methods):
    body = indent(dedent(methods), "    ")
    parts = "".join(dedent(text) for name, text in PARTS.items() if f"{name}(" in methods)
    assert ends(f"{HEAD}{parts}{ROBOT}{body}\nrclpy.init()\nrclpy.spin(Robot())\n") == {
        ("one/in", "one/out"),
        ("two/in", "two/out"),
    }


MIXING = {
    "one callback for all": "for topic in ('a', 'b'):\n    self.listen(topic, self.both)",
    "callbacks chosen by data": "for topic in ('a', 'b'):\n    self.listen(topic, self.chosen)",
    "a callback of an earlier row": """
        before = self.both
        for topic, callback in (("a", self.on_a), ("b", self.on_b)):
            self.listen(topic, before)
            before = self.both
    """,
    "a table whose rows are not known": """
        table = {name: self.both for name in self.names}
        table["a"] = table["b"] = self.both
        for topic in ("a", "b"):
            self.listen(topic, table[topic])
    """,
}
METHODS = """
    def both(self, msg):
        self.kept = msg
        self.x.publish(self.kept)
        self.y.publish(self.kept)

    def chosen(self, msg):
        (self.on_a if msg.data > 0 else self.on_b)(msg)

    def rows(self)"""


@pytest.mark.parametrize("wiring", MIXING.values(), ids=MIXING)
def test_table_rows_with_the_same_callback_have_the_same_flows(wiring):
    assert ends(node(wiring).replace("\n    def rows(self)", METHODS)) == EVERYTHING


def test_state_that_table_rows_share_connects_their_flows():
    wiring = """
        self.last = Float64()
        for topic, out in {"a": self.x, "b": self.y}.items():
            self.listen(topic, partial(self.relay, out))
    """
    relay = "\n    def relay(self, out, msg):\n        out.publish(self.last)\n        self.last = msg\n"
    assert ends(node(wiring).replace("\n    def rows(self)", f"{relay}\n    def rows(self)")) == EVERYTHING


def test_data_stored_by_one_row_reaches_later_rows():
    wiring = """
        callbacks = {"a": self.on_a}
        if len(self.names) > 1:
            callbacks["c"] = self.on_b
        before = last = self.on_a
        for topic, callback in callbacks.items():
            self.listen(topic + "/earlier", before)
            before = last = callback
        self.listen("last", last)
    """
    found = ends(node(wiring))
    assert {("a/earlier", "x"), ("c/earlier", "x"), ("last", "x"), ("last", "y")} <= found
    assert ("c/earlier", "y") not in found


def test_loop_over_publishers_connects_them_through_shared_state():
    wiring = """
        self.last = {"a": 0.0, "b": 0.0}
        self.outs = {"a": self.x, "b": self.y}
        for topic in ("a", "b"):
            self.listen(topic, partial(self.store, topic))
    """
    methods = """
    def store(self, topic, msg):
        self.last[topic] = msg.data
        total = 0.0
        for topic, value in self.last.items():
            total += value
            self.outs[topic].publish(Float64(data=total))

    def rows(self)"""
    assert ends(node(wiring).replace("\n    def rows(self)", methods)) == EVERYTHING


def test_flows_of_an_optional_table_row_are_found():
    wiring = """
        table = {"a": self.on_a}
        if len(self.names) > 2:
            table["b"] = self.on_b
        for topic, callback in table.items():
            self.listen(topic, callback)
    """
    assert ends(node(wiring)) == APART


def test_loop_over_marked_methods_subscribes_to_marked_topics_only():
    wiring = """
        for name in dir(self):
            method = getattr(self, name)
            if hasattr(method, "topic"):
                self.create_subscription(Float64, method.topic, method, 10)
            for topic in getattr(method, "topics", ()):
                self.create_subscription(Float64, topic, method, 10)
    """
    assert ends(node(wiring)) == APART


def test_a_decorator_of_a_library_may_mark_a_method():
    wiring = """
        for name in dir(self):
            method = getattr(self, name)
            if hasattr(method, "listens_to"):
                self.listen("a", method)
    """
    text = (
        node(wiring)
        .replace('@listens("a")', "@company.listens()")
        .replace("import rclpy\n", "import company\nimport rclpy\n")
    )
    assert ends(text) >= {("a", "x")}


def test_a_table_of_many_rows_is_one_source():
    topics = [f"t{number}" for number in range(MAX_ROWS + 1)]
    found = flows(node(f"for topic in {topics}:\n    self.listen(topic, self.on_a)"))
    assert {topic for flow in found for topic in flow.source.topics} == set(topics)
    assert len(found) == 1


def test_each_row_of_a_long_table_has_its_own_flows():
    topics = [f"t{number}" for number in range(MAX_ROWS)]
    found = flows(node(f"for topic in {topics}:\n    self.listen(topic, self.on_a)"))
    assert sorted(flow.source.topics for flow in found) == sorted((topic,) for topic in topics)


def test_nested_tables_are_distinguished_up_to_a_limit():
    wiring = """
        for side in ("l", "r"):
            for part in range({}):
                self.listen(f"{{side}}{{part}}", partial(self.on, "a" if side == "l" else "b"))
    """
    assert {(a[0], b) for a, b in ends(node(wiring.format(3)))} == {("l", "x"), ("r", "y")}
    text = """
        for one in range(9):
            for other in range(9):
                self.listen(f"t{one}", self.on_a)
    """
    assert {a for a, _ in ends(node(text))} == {f"t{number}" for number in range(9)}
