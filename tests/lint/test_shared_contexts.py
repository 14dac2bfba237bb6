"""If calls share a context, no flow is missed and long programs are analysed completely."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tarl_lint.api import analyse
from tarl_lint.interpret import context_selection
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.read.source import Module
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config

CASES = Path(__file__).parent.parent / "cases"
HELPERS = [
    unit
    for unit in sorted(CASES.rglob("*.py"))
    if unit.read_text().count("def ") > 6 and not (unit.parent / "__init__.py").exists()
][::3]


@pytest.fixture
def sharing(monkeypatch):
    """Make all calls of a function share a context."""
    monkeypatch.setattr(context_selection, "SEPARATE_STATEMENTS", -1)
    monkeypatch.setattr(context_selection, "SEPARATE_CALLS", -1)


def pairs(unit: Path) -> set[tuple[object, object]]:
    return {(flow.source.span, flow.sink.span) for flow in analyse([unit]).flows}


def linked(text: str) -> Linker:
    machine = Linker([Module("node.py", "node", text, ast.parse(text))], Config(), thorough=False)
    with_deep_stack(machine.link)
    return machine


@pytest.mark.parametrize("unit", HELPERS, ids=lambda p: p.relative_to(CASES).with_suffix("").as_posix())
def test_no_pair_of_source_and_sink_is_missed(unit, monkeypatch):
    apart = pairs(unit)
    monkeypatch.setattr(context_selection, "SEPARATE_STATEMENTS", -1)
    monkeypatch.setattr(context_selection, "SEPARATE_CALLS", -1)
    assert apart <= pairs(unit)


TWO = """
import rospy
pub = rospy.Publisher("out", F)
clean = rospy.Publisher("clean", F)
def same(x):
    return x
def on(msg):
    same(1)
    pub.publish(same(msg.data))
    clean.publish(same(2))
rospy.Subscriber("in", F, on)
"""


def test_data_passes_between_callers_only_in_a_shared_context(tmp_path, monkeypatch):
    (tmp_path / "node.py").write_text(TWO)
    assert [f.sink.topics for f in analyse([tmp_path]).flows] == [("out",)]
    monkeypatch.setattr(context_selection, "SEPARATE_STATEMENTS", -1)
    monkeypatch.setattr(context_selection, "SEPARATE_CALLS", -1)
    assert [f.sink.topics for f in analyse([tmp_path]).flows] == [("out",), ("clean",)]


CHOSEN = """
import rospy
pub = rospy.Publisher("out", F)
def send(x):
    pub.publish(F(x))
def on(msg):
    send(1)
    if msg.data > 0:
        send(2)
rospy.Subscriber("in", F, on)
"""


@pytest.mark.usefixtures("sharing")
def test_conditions_of_all_callers_decide_a_shared_call(tmp_path):
    (tmp_path / "node.py").write_text(CHOSEN)
    assert [f.kind for f in analyse([tmp_path]).flows] == ["implicit"]


RESULT = """
import rospy
pub = rospy.Publisher("out", F)
chosen = rospy.Publisher("chosen", F)
scale = rospy.get_param("scale")
def scaled(x):
    return x * scale
def on(msg):
    if msg.data > 0:
        rospy.loginfo(scaled(1))
        value = scaled(2)
    else:
        value = 0
    pub.publish(scaled(3))
    chosen.publish(value)
rospy.Subscriber("in", F, on)
"""


@pytest.mark.usefixtures("sharing")
def test_conditions_of_other_callers_do_not_decide_a_shared_result(tmp_path):
    (tmp_path / "node.py").write_text(RESULT)
    assert [(f.sink.topics, f.kind) for f in analyse([tmp_path]).flows] == [(("chosen",), "implicit")]


@pytest.mark.usefixtures("sharing")
def test_each_callback_supplier_stays_a_separate_subscription(tmp_path):
    (tmp_path / "node.py").write_text(
        "import rospy\npub = rospy.Publisher('out', F)\n"
        "def listen(topic, callback):\n    rospy.Subscriber(topic, F, callback)\n"
        "def on(msg):\n    pub.publish(msg)\nlisten('a', on)\nlisten('b', on)\n"
    )
    assert sorted(f.source.topics for f in analyse([tmp_path]).flows) == [("a",), ("b",)]


@pytest.mark.usefixtures("sharing")
def test_recursion_through_a_shared_context_ends():
    machine = linked(
        "import rospy\npub = rospy.Publisher('out', F)\n"
        "def down(x, n):\n    return down(x + 1, n - 1) if n else x\n"
        "def on(msg):\n    pub.publish(down(msg.data, 3))\nrospy.Subscriber('in', F, on)\n"
    )
    assert not machine.cut
    assert len(machine.sinks) == 1


def tree_of_calls(depth: int, width: int) -> str:
    """Return a node whose functions each call the next one several times: contexts grow exponentially with depth."""
    levels = "".join(
        f"def f{n}(x):\n" + f"    x = f{n + 1}(x)\n" * width + "    return x\n" for n in range(depth)
    )
    return (
        f"import rospy\npub = rospy.Publisher('out', F)\n{levels}def f{depth}(x):\n    return x\n"
        "def on(msg):\n    pub.publish(f0(msg.data))\nrospy.Subscriber('in', F, on)\n"
    )


def test_programs_with_exponentially_many_contexts_are_analysed_completely(monkeypatch):
    monkeypatch.setattr(context_selection, "SEPARATE_STATEMENTS", 300)
    machine = linked(tree_of_calls(depth=8, width=4))
    assert not machine.cut
    assert machine.widened
    assert machine.total < 20_000  # 4 ** 8 contexts are 65,536
