"""If an execution shows that an output depends on a topic's messages, the linter reports a flow from this topic."""

from __future__ import annotations

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tests.lint.executed.generating import Generator
from tests.lint.executed.running import UnhandledError, dependences, published
from tests.lint.executed.shrinking import shrunk
from tests.slow import SEED, slow

PROGRAMS = 40
EXECUTIONS = 60  # pairs of executions of a program for each topic
BATCHES, BATCH = 12, 250


def reported(text: str) -> set[tuple[str, str]]:
    module = parse("node.py", text.encode(), "node")
    assert isinstance(module, Module)
    flows = engine.analyse([module], Config())
    return {(t, out) for flow in flows for t in flow.source.topics for out in flow.sink.topics}


def small(text: str, flow: tuple[str, str], seed: int) -> str:
    return shrunk(text, lambda t: flow in dependences(t, seed, EXECUTIONS) - reported(t))


def assert_reported(seeds: range) -> None:
    shown = 0
    for seed in seeds:
        text = Generator(seed).program()
        found = dependences(text, seed, EXECUTIONS)
        shown += len(found)
        missing = sorted(found - reported(text))
        if missing:
            pytest.fail(f"seed {seed}: no flow {missing[0]} in\n{small(text, missing[0], seed)}")
    assert shown > len(seeds) / 2  # the programs show something


def test_the_linter_reports_flows_that_executions_show():
    assert_reported(range(PROGRAMS))


@slow
@pytest.mark.parametrize("batch", range(1, BATCHES + 1))
def test_linter_reports_the_flows_of_executed_programs(batch):
    first = (SEED * (BATCHES + 1) + batch) * BATCH
    assert_reported(range(first, first + BATCH))


NODE = """\
import rospy
from std_msgs.msg import Float64
class Node:
    def __init__(self):
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("a", Float64, self.on_a)
        rospy.Subscriber("b", Float64, self.on_b)
    def on_a(self, msg):
        pass
        if msg.data > 1:
            raise ValueError
        self.out.publish(1)
    def on_b(self, msg):
        x = [][int(msg.data > 9)]
Node()
"""


def run(text, *events):
    return published(compile(text, "node.py", "exec"), text.splitlines(), events)


def test_an_execution_shows_what_was_published():
    assert run(NODE, ("a", 0), ("a", 2), ("a", 1)) == {"out": [1, 1]}
    assert dependences(NODE, 1, 40) == {("a", "out")}


def test_unhandled_exception_of_a_program_is_an_unhandled_error():
    with pytest.raises(UnhandledError):
        run(NODE, ("b", 0))


def test_error_in_a_generated_program_is_reported():
    with pytest.raises(NameError):
        run(NODE.replace("raise ValueError", "missing"), ("a", 2))


def test_a_random_program_depends_only_on_its_seed():
    assert Generator(5).program() == Generator(5).program() != Generator(6).program()


def test_shrinking_removes_irrelevant_statements():
    left = shrunk(NODE, lambda text: ("a", "out") in dependences(text, 1, 40))
    assert "raise" in left
    assert "on_b" not in left
