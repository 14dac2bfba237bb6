"""What chooses the object that a statement or a call stores into decides the content of each possible object."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import flows

NODE = """\
import rospy
from std_msgs.msg import Float64


class Side:
    def __init__(self):
        self.last = 0.0
        self.all = []

    def put(self, value):
        self.last = value


class Sorter:
    def __init__(self):
        self.limit = 0.0
        self.left, self.right = {make}, {make}
        self.sides = {{"left": self.left, "right": self.right}}
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("item", Float64, self.on_item)
        rospy.Subscriber("limit", Float64, self.on_limit)
        rospy.Subscriber("ask", Float64, self.on_ask)

    def on_limit(self, msg):
        self.limit = msg.data

    def on_item(self, msg):
        side = {choose}
        {store}

    def on_ask(self, msg):
        self.out.publish({read})


rospy.init_node("sorter")
Sorter()
rospy.spin()
"""
CHOSEN = [
    "self.left if self.limit > 1.0 else self.right",
    'self.sides["left" if self.limit > 1.0 else "right"]',
]
ONE = ["self.left", 'self.sides["left"]']
STORES = [
    ("Side()", "side.last = msg.data", "self.left.last"),
    ("Side()", "side.put(msg.data)", "self.left.last"),
    ("Side()", "side.all.append(msg.data)", "sum(self.left.all)"),
    ("Side()", 'setattr(side, "last", msg.data)', "self.left.last"),
    ("[0.0]", "side[0] = msg.data", "self.left[0]"),
    ("[]", "side.append(msg.data)", "sum(self.left)"),
    ("[]", "side.extend([msg.data])", "sum(self.left)"),
    ("[]", "side.insert(0, msg.data)", "sum(self.left)"),
    ("{}", 'side["a"] = msg.data', 'self.left["a"]'),
    ("{}", "side.update(a=msg.data)", 'self.left["a"]'),
    ("set()", "side.add(msg.data)", "sum(self.left)"),
]


def found(choose: str, make: str, store: str, read: str) -> set[tuple[str, ...]]:
    """Return topic and kind of each flow of a node that stores into `side`."""
    text = NODE.format(choose=choose, make=make, store=store, read=read)
    return {(*flow.source.topics, flow.kind) for flow in flows(text)}


@pytest.mark.parametrize(("make", "store", "read"), STORES)
@pytest.mark.parametrize("choose", CHOSEN)
def test_the_choice_decides_the_content(choose: str, make: str, store: str, read: str) -> None:
    assert {("item", "explicit"), ("limit", "implicit")} <= found(choose, make, store, read)


@pytest.mark.parametrize(("make", "store", "read"), STORES)
@pytest.mark.parametrize("choose", ONE)
def test_nothing_decides_the_content_without_a_choice(choose: str, make: str, store: str, read: str) -> None:
    assert found(choose, make, store, read) == {("item", "explicit")}


def test_a_condition_inside_an_expression_decides_what_is_stored() -> None:
    store = "self.limit > 1.0 and self.left.append(msg.data)"
    assert found("None", "[]", store, "sum(self.left)") == {("item", "explicit"), ("limit", "implicit")}
