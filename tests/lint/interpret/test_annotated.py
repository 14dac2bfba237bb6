"""What code outside the files passes: objects of the classes that annotate parameters."""

from __future__ import annotations

import pytest

from tarl_lint.interpret import annotated
from tarl_lint.interpret.budget import MAX_ALIKE
from tarl_lint.memory.values import Obj, Value
from tests.lint.models.marked import differing

HEAD = """\
import rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# Programs, each below its title.
PROGRAMS = """\
### a runner that gets the root of a tree
class Behaviour:
    def setup(self, node):
        self.node = node
    def update(self):
        return 0.0
class Heard(Behaviour):
    def __init__(self, topic: str):
        self.topic, self.last = topic, 0.0
    def setup(self, node):
        node.create_subscription(Float64, self.topic, self.receive, 1)
    def receive(self, msg):
        self.last = msg.data
    def update(self):
        return self.last
class Runner:
    def __init__(self, node: Node, root: Behaviour):
        self.root = root
        self.pub = node.create_publisher(Float64, "state", 1)
        root.setup(node)
        node.create_timer(0.1, self.tick)
    def tick(self):
        self.pub.publish(self.root.update())  # data
        self.pub.publish(1.0)  # clean
### composites with lists of children
from typing import List, Optional
class Behaviour:
    def update(self):
        return 0.0
class Heard(Behaviour):
    def __init__(self):
        self.last = 0.0
        rospy.Subscriber("in", Float64, self.receive)
    def receive(self, msg):
        self.last = msg.data
    def update(self):
        return self.last
class Sequence(Behaviour):
    def __init__(self, children: "List[Behaviour]", name: Optional[str] = None):
        self.children = children
    def update(self):
        return max(child.update() for child in self.children)
class Runner:
    def __init__(self, root: Optional[Behaviour]):
        self.root = root
        self.pub = rospy.Publisher("state", Float64, queue_size=1)
        rospy.Timer(0.1, self.tick)
    def tick(self, event):
        self.pub.publish(self.root.update())  # data
### leaves that only publish what stands on a board
class Board(dict):
    pass
class Leaf:
    def setup(self, node, board: Board):
        self.board = board
class Hear(Leaf):
    def setup(self, node, board: Board):
        super().setup(node, board)
        node.create_subscription(Float64, "in", self.receive, 1)
    def receive(self, msg):
        self.board["x"] = msg.data
class Say(Leaf):
    def setup(self, node, board: Board):
        super().setup(node, board)
        self.pub = node.create_publisher(Float64, "out", 1)
    def tick(self):
        self.pub.publish(self.board["x"])  # data
        self.pub.publish(self.board["y"])  # clean
class Runner:
    def __init__(self, node, leaf: Leaf):
        self.leaf = leaf
        board = Board()
        leaf.setup(node, board)
        node.create_timer(0.1, self.leaf.tick)
### a class that the files make is not passed by others
class Store:
    def __init__(self):
        self.value = 0.0
class Runner:
    def __init__(self, store: Store):
        self.store = store
        self.pub = rospy.Publisher("state", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on)
        rospy.Timer(0.1, self.tick)
    def on(self, msg):
        self.store.value = msg.data
    def tick(self, event):
        self.pub.publish(self.store.value)  # data
first, second = Store(), Store()
Runner(first)
def show(event):
    out.publish(second.value)  # clean
rospy.Timer(0.1, show)
### tools with an object of the files
from agents import tool
class Robot:
    def __init__(self):
        self.seen = 0.0
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.seen = msg.data
@tool
def tell(robot: Robot, words: str):
    out.publish(robot.seen)  # data
    out.publish(words)  # clean
Robot()
"""
CASES = dict(part.split("\n", 1) for part in PROGRAMS.split("### ")[1:])


@pytest.mark.parametrize("title", CASES)
def test_parameters_get_the_objects_that_other_code_passes(title):
    assert differing(HEAD + CASES[title]) == {}


def test_few_objects_represent_all_objects_of_a_class():
    first, second = Obj("class", "A"), Obj("class", "B")
    many = [Obj("instance", number) for number in range(MAX_ALIKE + 2)]
    for obj in many:
        obj.info = first
    other = Obj("instance", "other")
    other.info = second
    whole = Value(frozenset([3]), frozenset([*many, other]))
    kept = annotated._some(whole)
    assert (kept.deps, kept.objects) == (whole.deps, [*many[:MAX_ALIKE], other])
    assert annotated._some(kept) is kept
