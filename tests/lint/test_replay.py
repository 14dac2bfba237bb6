"""Calls are replayed only if all their reads are unchanged, and then with the same result."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret import call_replay
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory import recency, updates
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.shared import Root
from tarl_lint.memory.store import Delta, Store
from tarl_lint.memory.value_flow_graph import MANY, MANY_CARRIERS
from tarl_lint.memory.values import Value, pointer
from tarl_lint.model import Flow
from tarl_lint.read.source import Module
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config
from tests.lint.combining import AXES, node
from tests.slow import SLOW, chance

CASES = Path(__file__).parents[1] / "cases"
DATA = frozenset([1])
OTHER = frozenset([2])
HEAD = """
import threading
import rospy
from std_msgs.msg import Float64
"""
HELPERS = f"""{HEAD}
class Filter:
    def __init__(self):
        self.state, self.log, self.table = 0.0, [], {{}}
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.heard)
        rospy.Subscriber("other", Float64, self.heard_too)

    def heard(self, msg):
        self.state = self.smooth(msg.data)
        self.note("in", self.state)

    def heard_too(self, msg):
        self.note("other", msg.data)

    def smooth(self, x):
        return 0.9 * self.state + 0.1 * x

    def note(self, name, x):
        self.log.append(x)
        self.table[name] = x

    def send(self):
        for name in ("in", "other"):
            self.pub.publish(self.table[name] + self.smooth(1.0))

    def run(self):
        while not rospy.is_shutdown():
            self.send()
            self.pause()

    def pause(self):
        rospy.sleep(0.1)

Filter().run()
"""


RAISING = f"""{HEAD}
class Limits:
    def __init__(self):
        self.state, self.speeds = 0.0, []
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.heard)
        rospy.Subscriber("other", Float64, self.heard_too)

    def heard(self, msg):
        self.pub.publish(self.total(msg.data) + self.state)
        self.state = self.speeds[0]

    def heard_too(self, msg):
        self.speeds = [msg.data]

    def total(self, values):
        total = 0.0
        for value in values:
            last = self.speeds
            total += value * len(last)
            if value > 3:
                raise ValueError(value)
        return total

Limits()
rospy.spin()
"""


def linked(text: str, *, checking: bool = False) -> Linker:
    machine = Linker([Module("node.py", "node", text, ast.parse(text))], Config(), thorough=False)
    machine.checking = checking
    with_deep_stack(machine.link)
    return machine


def flows(machine: Linker) -> tuple[Flow, ...]:
    return Tracer(machine).flows()


@pytest.fixture
def store() -> Store:
    machine = linked("x = 1\n")
    return Store(machine.shared, Root("test", "test"))


@pytest.fixture
def obj(store):
    return recency.intern(linked("x = 1\n"), "sequence", "a")


def test_read_of_a_stored_key_does_not_belong_to_the_call(store, obj):
    store.get((obj, "x"))
    store.put((obj, "x"), Value(DATA))
    store.put((obj, "y"), Value(DATA))
    store.get((obj, "y"))
    assert store.reads.keys == {(obj, "x")}


def test_store_in_one_branch_does_not_hide_a_read_in_another(store, obj):
    store.push()
    store.put((obj, "x"), Value(DATA))
    store.pop()
    store.get((obj, "x"))
    assert store.reads.keys == {(obj, "x")}


def test_reads_of_a_call_count_for_its_caller(store, obj):
    inner, outer = Reads(), Reads()
    inner.keys |= {(obj, "x"), (obj, "y")}
    outer.written.add((obj, "x"))
    outer.add(inner)
    assert outer.keys == {(obj, "y")}
    outer.written.clear()
    outer.left += 1  # ends the path on which the value was stored
    outer.add(inner)
    assert outer.keys == {(obj, "x"), (obj, "y")}


def test_a_call_records_its_first_read_of_an_object(store, obj):
    store.look(obj)
    store.put((obj, "x"), Value(DATA))
    store.look(obj)
    assert store.reads.objects[obj] < obj.stamp


def test_absorbing_a_layer_equals_storing_its_values(store, obj):
    deltas: list[Delta] = []
    for absorb in (True, False):
        store.push()
        store.put((obj, "x"), Value(DATA))
        delta = store.pop()
        store.push()
        if absorb:
            store.absorb(delta)
        else:
            store.put((obj, "x"), delta[obj, "x"])
        deltas.append(store.since(1))
        store.pop()
        assert store.get((obj, "x")) is None
    assert deltas[0] == deltas[1]


def test_calls_with_unchanged_reads_run_once(monkeypatch):
    replayed = linked(HELPERS)
    monkeypatch.setattr(call_replay, "_same", lambda *_: False)
    executed = linked(HELPERS)
    assert flows(replayed) == flows(executed) != ()
    assert replayed.total < 0.85 * executed.total


def test_a_replay_equals_an_execution():
    assert flows(linked(HELPERS, checking=True)) == flows(linked(HELPERS))


def test_replay_equals_execution_with_fewer_loop_passes():
    linked(RAISING, checking=True)


def test_a_replay_that_differs_is_reported(monkeypatch):
    monkeypatch.setattr(call_replay, "unchanged", lambda *_: True)
    with pytest.raises(AssertionError, match="new edges"):
        linked(HELPERS, checking=True)


def units() -> list[Path]:
    """Return a sample of the marked cases, all of them in slow runs."""
    every = sorted(p for p in CASES.rglob("*.py") if p.name != "__init__.py")
    return every if SLOW else chance(12).sample(every, 12)


@pytest.mark.parametrize("path", units(), ids=lambda p: str(p.relative_to(CASES)))
def test_replays_of_the_test_cases_equal_executions(path):
    linked(path.read_text(), checking=True)


def test_replays_of_randomly_generated_nodes_equal_executions():
    draw = chance(3)
    for _ in range(60 if SLOW else 6):
        linked(node(*(draw.choice(sorted(axis)) for axis in AXES)), checking=True)


# --- merged fields -------------------------------------------------------------------------------


def many(number: int) -> str:
    """Return a node with many callbacks that add to one list, and one callback that publishes an element."""
    callbacks = "".join(
        f"def on_{n}(msg):\n    kept.append(msg.data)\nrospy.Subscriber('in{n}', Float64, on_{n})\n"
        for n in range(number)
    )
    last = "def tick(event):\n    pub.publish(kept[i])\nrospy.Timer(rospy.Duration(1), tick)\n"
    return f"{HEAD}\nkept = []\npub = rospy.Publisher('out', Float64, queue_size=1)\n{callbacks}{last}"


def chosen_later(number: int) -> str:
    text = many(number).replace("pub.publish(kept[i])", "if kept[i] > 1:\n        pub.publish(1)")
    return text.replace("kept.append(msg.data)", "add(msg.data)") + "def add(x):\n    kept.append(x)\n"


@pytest.mark.parametrize("number", [2, MANY - 1, MANY + 8, MANY_CARRIERS + 2])
@pytest.mark.parametrize(("made", "kind"), [(many, "explicit"), (chosen_later, "implicit")])
def test_merged_field_passes_on_all_values(number, made, kind):
    found = flows(linked(made(number)))
    assert {(f.kind, *f.source.topics) for f in found} == {(kind, f"in{n}") for n in range(number)}


@pytest.mark.parametrize("added", ["msg.data", "msg.data + 1"])
def test_merging_field_values_adds_no_steps_to_other_flows(added):
    found = flows(linked(many(MANY + 4).replace("msg.data", added)))
    for flow in found:
        (name,) = flow.source.topics
        added = [s.code for s in flow.steps if "append" in s.code]
        assert len(added) == 1
        assert [s.code for s in flow.steps][-1].startswith("pub.publish")
        assert f"def on_{name[2:]}" in "".join(s.code for s in flow.steps)


def test_merging_field_values_takes_linear_time():
    totals = [linked(many(number)).total for number in (MANY, 2 * MANY)]
    assert totals[1] < 2.3 * totals[0]


def test_a_replaced_field_drops_its_merged_values(store, obj):
    machine = linked("x = 1\n")
    store = machine.store = Store(machine.shared, Root("test", "test"), gather=machine.gathered)
    (program,) = machine.programs.values()
    machine.stack = [machine.frames["module", program.path]]
    nodes = [machine.node(machine.stack[0], ("made", n), "assign") for n in range(MANY + 1)]
    updates.add_element(machine, pointer(obj), Value(frozenset(nodes)))
    (meeting,) = store.now[obj, "*"].deps
    assert machine.graph.data[meeting] == set(nodes)
    updates.add_element(machine, pointer(obj), Value(frozenset(nodes[:1])))
    assert store.now[obj, "*"].deps == {meeting}
    store.put((obj, "*"), Value(OTHER))
    assert store.now[obj, "*"].deps == OTHER
