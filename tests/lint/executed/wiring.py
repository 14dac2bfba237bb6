"""The publishers and subscriptions of a generated node: written out, or in loops over tables and marked methods."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Final

MAX_OUTPUTS: Final = 12  # number of publishers up to which a loop makes them

CLASSES: Final = """\
class Output:
    def __init__(self, topic):
        self.pub = rospy.Publisher(topic, Float64, queue_size=1)

    def publish(self, value):
        self.pub.publish(value)


class Listener:
    def listen(self, topic, callback):
        rospy.Subscriber(topic, Float64, callback)

    def listen_to_marked(self):
        for name in dir(type(self)):
            method = getattr(self, name)
            if hasattr(method, "topic"):
                rospy.Subscriber(method.topic, Float64, method)

    def listen_to_lists(self):
        for name in dir(self):
            for topic in getattr(getattr(self, name), "topics", ()):
                self.listen(topic, getattr(self, name))


def marked(topic):
    def mark(method):
        method.topic = topic
        method.__dict__.setdefault("topics", []).append(topic)
        return method

    return mark


"""
TIMER: Final = "rospy.Timer(rospy.Duration(1), self.tick)"
SUBSCRIPTIONS: Final[Sequence[Sequence[str]]] = (
    ['rospy.Subscriber("a", Float64, self.on_a)', 'rospy.Subscriber("b", Float64, self.on_b)'],
    ['rospy.Subscriber("a", Float64, self.on_a)', 'rospy.Subscriber("b", Float64, self.on_b)'],
    ['for topic, callback in (("a", self.on_a), ("b", self.on_b)):', "    self.listen(topic, callback)"],
    [
        'table = {"a": self.on_a}',
        'table["b"] = self.on_b',
        "for topic, callback in sorted(table.items()):",
        "    self.listen(topic, callback)",
    ],
    [
        "table = []",
        'table.append(("a", self.on_a))',
        'table.append(("b", self.on_b))',
        "for topic, callback in table:",
        "    rospy.Subscriber(topic, Float64, callback)",
    ],
    [
        'for i, topic in enumerate(["a", "b"]):',
        "    self.listen(topic, lambda msg, i=i: (self.on_a, self.on_b)[i](msg))",
    ],
    ['for topic, callback in zip(["a", "b"], [self.on_a, self.on_b]):', "    self.listen(topic, callback)"],
    ['self.subscribers = {t: rospy.Subscriber(t, Float64, getattr(self, "on_" + t)) for t in ("a", "b")}'],
    ["self.listen_to_marked()"],
    ["self.listen_to_lists()"],
)


def wiring(seed: int, outputs: int) -> list[str]:
    """Return the statements that connect a node with its topics; the same seed gives the same ones."""
    draw = random.Random(f"wiring {seed}")
    return [*_publishers(draw, outputs), *draw.choice(SUBSCRIPTIONS), TIMER]


def _publishers(draw: random.Random, outputs: int) -> list[str]:
    """Return the statements that make the publishers `self.out0`, `self.out1` …"""
    kind = draw.choice(["plain", "plain", "wrapped", "loop", "table"])
    made = f"{'Output' if draw.random() < 0.5 else 'rospy.Publisher'}(name{{}})"
    made = made.format("" if "Output" in made else ", Float64, queue_size=1")
    if kind == "loop" and outputs <= MAX_OUTPUTS:
        return [f"for i in range({outputs}):", '    name = f"out{i}"', f"    setattr(self, name, {made})"]
    if kind == "table" and outputs <= MAX_OUTPUTS:
        names = [f"out{number}" for number in range(outputs)]
        return [f"pubs = {{name: {made} for name in {names}}}", *(f'self.{n} = pubs["{n}"]' for n in names)]
    maker = 'Output("out{0}")' if kind == "wrapped" else 'rospy.Publisher("out{0}", Float64, queue_size=1)'
    return [f"self.out{number} = {maker.format(number)}" for number in range(outputs)]
