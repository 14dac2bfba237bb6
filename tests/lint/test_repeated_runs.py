"""Which stores of an entry point make it run again."""

from __future__ import annotations

import ast
import gc
from collections import Counter

import pytest

from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.read.source import Module
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config

NODE = """
import rospy
from lib import Net
from std_msgs.msg import Float64

class Node:
    def __init__(self):
        self.x = 0
        self.net = None
        self.box = Net()
        self.keep = None
        self.pub = rospy.Publisher("out", Float64)
        rospy.Subscriber("in", Float64, self.on)

    def on(self, msg):
        {body}

rospy.init_node("n")
Node()
rospy.spin()
"""


class Counted(Linker):
    """Counts the runs of each entry point by its name."""

    def __init__(self, text):
        super().__init__([Module("node.py", "node", text, ast.parse(text))], Config(), thorough=False)
        self.runs = Counter()

    def _run(self, root, run):
        self.runs[root.name] += 1
        super()._run(root, run)


def linked(*lines):
    machine = Counted(NODE.format(body="\n        ".join(lines)))
    with_deep_stack(machine.link)
    return machine


@pytest.mark.parametrize(
    "lines",
    [
        ["if msg.data > 0:", "    net = Net()", "    net.size = 3"],
        ["if msg.data > 0:", "    rows = [1]", "    rows.append(2)"],
        ["net = Net()", "for n in range(3):", "    net.size = n", "use = net.size"],
        ["if msg.data > 0:", "    twice = 2", "    self.pub.register(lambda: twice)"],
    ],
)
def test_stores_to_objects_of_one_run_rerun_nothing(lines):
    assert linked(*lines).runs["on"] == 1


@pytest.mark.parametrize(
    "lines",
    [
        ["self.pub.publish(self.x)", "self.x = msg.data"],
        ["if msg.data > 0:", "    self.x = msg.data", "else:", "    self.pub.publish(self.x)"],
        ["if msg.data > 0:", "    self.x = 0", "self.pub.publish(self.x)", "self.x = msg.data"],
        ["if msg.data > 0:", "    self.box.x = 0", "self.pub.publish(self.box.x)", "self.box.x = msg.data"],
        ["if self.net is None:", "    self.net = Net()", "self.pub.publish(self.net.last)", "self.net.last = msg.data"],
        [
            "if self.keep is None:",
            "    self.keep = []",
            "for x in self.keep:",
            "    self.pub.publish(x)",
            "self.keep.append(msg.data)",
        ],
        [
            "if self.keep is not None:",
            "    self.pub.publish(self.keep())",
            "else:",
            "    x = msg.data",
            "    self.keep = lambda: x",
        ],
    ],
)  # fmt: skip
def test_run_reads_values_of_earlier_runs(lines):
    machine = linked(*lines)
    assert machine.runs["on"] > 1
    assert [flow.kind for flow in Tracer(machine).flows()] == ["explicit"]


ROBOTS = """
import rospy
from std_msgs.msg import Float64, String

class Robot:
    def __init__(self):
        self.x = 0
        self.pub = rospy.Publisher("out", Float64)
        rospy.Subscriber("in", Float64, self.on)

    def on(self, msg):
        self.x = msg.data
        self.pub.publish(self.x)

class Other:
    def __init__(self):
        self.pub = rospy.Publisher("other_out", Float64)
        rospy.Subscriber("other_in", Float64, self.other)

    def other(self, msg):
        self.pub.publish(msg.data)

def more(msg):
    for name in msg.data:
        Robot()

rospy.init_node("n")
Other()
rospy.Subscriber("more", String, more)
rospy.spin()
"""


def test_only_storing_entry_points_run_again_after_a_merge():
    machine = Counted(ROBOTS)
    with_deep_stack(machine.link)
    assert any(obj.many and obj.name == "Robot" for obj in machine.objects.values())
    assert machine.runs["on"] == 2
    assert machine.runs["other"] == 1


def test_call_records_are_dropped_after_the_last_run():
    machine = linked("self.pub.publish(self.double(msg.data))")
    assert machine.runs["on"] == 1
    assert any(frame.function.name == "on" for frame in machine.frames.values())
    assert all(frame.recorded is None for frame in machine.frames.values())


def test_tracing_flows_leaves_no_reference_cycles():
    """The garbage collector is paused during an analysis, so a cycle would keep each program's graph in memory."""
    machine = linked("self.pub.publish(self.x)", "self.x = msg.data")
    tracer = Tracer(machine)
    assert tracer.flows()
    tracer.texts.release()
    gc.collect()
    del tracer
    assert gc.collect() == 0
