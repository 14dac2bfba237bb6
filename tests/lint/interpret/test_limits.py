"""Beyond a limit, an analysis is less precise but finds all flows of data, and an incomplete program is named."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.interpret import calls, context_selection, fixpoint, operators
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing, flows, in_callback


def machine(text: str, **given) -> Linker:
    made = Linker([Module("node.py", "node", text, ast.parse(text))], Config(), **given)
    made.link()
    return made


LIBRARY = """
import library
objects = [library.Filter(n) for n in range(3)] + [library.Filter(4), library.Filter(5), library.Other()]
for one in objects:
    one.update(msg.data)
out.publish(objects[0].value())  # data
out.publish(objects[5].value())  # data
out.publish([one.value() for one in objects][0])  # data
clean = [library.Filter(6), library.Filter(7)]
out.publish(clean[0].value())  # clean
out.publish([one.value() for one in clean][0])  # clean
"""


@pytest.mark.parametrize("most", [0, 1, 5, 100])
def test_call_on_one_of_many_library_objects_covers_all(monkeypatch, most):
    monkeypatch.setattr(calls, "MAX_ALIKE", most)
    assert differing(in_callback(LIBRARY)) == {}


CHAIN = """
def one(x):
    return two(x)
def two(x):
    return three(x)
def three(x):
    return [x, 0.0]
"""


@pytest.mark.parametrize("most", [1, 2, 3])
def test_call_beyond_the_context_limit_returns_its_arguments(monkeypatch, most):
    body = "out.publish(one(msg.data)[0])  # data\nout.publish(one(1.0)[0])  # clean"
    assert differing(in_callback(body, CHAIN)) == {}
    assert machine(in_callback(body, CHAIN)).cut == {}
    monkeypatch.setattr(context_selection, "MAX_FRAMES", most)
    assert differing(in_callback(body, CHAIN)) == {}
    assert list(machine(in_callback(body, CHAIN)).cut) == ["node.py"]


def test_an_analysis_with_too_many_edges_ends_early(monkeypatch):
    text = in_callback("out.publish(msg.data)")
    edges = machine(text).graph.edges
    monkeypatch.setattr(fixpoint, "MAX_EDGES", edges + 1)
    assert machine(text).cut == {}
    monkeypatch.setattr(fixpoint, "MAX_EDGES", edges)
    assert list(machine(text).cut) == ["node.py"]


def test_entry_points_run_until_nothing_changes(monkeypatch):
    steps = "\n".join(f"def on_{n}(msg):\n    global x_{n + 1}\n    x_{n + 1} = x_{n}" for n in range(6))
    names = "\n".join(f"x_{n} = 0.0" for n in range(8))
    registered = "\n".join(f'rospy.Subscriber("s{n}", Float64, on_{n})' for n in reversed(range(6)))
    body = "global x_0\nx_0 = msg.data\nout.publish(x_6)"
    text = in_callback(body, f"{names}\n{steps}") + registered

    def reached() -> bool:
        return any(flow.source.topics == ("in",) for flow in flows(text))

    assert reached()
    monkeypatch.setattr(fixpoint, "MAX_ROUNDS", 1)
    assert not reached()


def test_crash_on_one_file_is_stored_or_raised(monkeypatch):
    def crash(*_: object) -> bool:
        raise KeyError("x")

    text = in_callback("out.publish(msg.data)")
    monkeypatch.setattr(fixpoint, "lower_module", crash)
    with pytest.raises(KeyError):
        machine(text)
    failures: dict[str, Exception] = {}
    assert machine(text, failures=failures).programs == {}
    assert list(failures) == ["node.py"]


def test_only_the_first_crash_on_a_file_is_stored():
    made = machine("x = 1\n", failures={})
    first, second = ValueError(), KeyError()
    made._failed("a.py", first)
    made._failed("a.py", second)
    assert made.failures == {"a.py": first}


NAMES = """
side = "left" if rospy.get_time() > 1.0 else "right"
pub = rospy.Publisher(side + "/" + side, Float64)
pub.publish(msg.data)
"""


def topics(body: str) -> set[str]:
    return {name for flow in flows(in_callback(body)) for name in flow.sink.topics}


def test_combinations_of_topic_name_parts_are_limited(monkeypatch):
    assert topics(NAMES) == {"left/left", "left/right", "right/left", "right/right"}
    monkeypatch.setattr(operators, "MAX_TEXTS", 3)
    assert topics(NAMES) == set()


@pytest.mark.parametrize("length", [1, 300, 301])
def test_topic_names_are_computed_up_to_300_characters(length):
    body = f'pub = rospy.Publisher("{"a" * (length - 1)}" + "b", Float64)\npub.publish(msg.data)'
    assert topics(body) == ({"a" * (length - 1) + "b"} if length <= 300 else set())
