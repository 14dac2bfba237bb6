"""The expressions at which templates may be written: kinds, statements in order, and pairs that differ in an axis."""

from __future__ import annotations

import ast
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.repairing.template_places import Spot, _away, _expressions, _fields, _sides, _steps, pairs
from pytest_tarl.repairing.template_places import constants as constants_of
from tarl_lint.model import SiteId, Span


def found(
    text: str, *, numeric: bool = True, returned: tuple[str, ...] = (), line: int = 1
) -> list[tuple[str, str]]:
    source = document("a.py", text + "\n")
    span = Span("a.py", line, 1, line, 9)
    return [(ast.unparse(node), kind) for node, kind in _expressions(source, span, numeric, returned)]


@pytest.mark.parametrize(
    ("text", "numeric", "places"),
    [
        ("if a < b: pass", True, [("a < b", "comparison")]),
        ("while a >= b and c > d: pass", True, [("a >= b", "comparison"), ("c > d", "comparison")]),
        ("if a == b or c in d or not e: pass", True, []),
        ("if a < b < c: pass", True, []),
        ("x = a + b", False, [("a + b", "value")]),
        ("x: float = a * b", False, [("a * b", "value")]),
        ("x += -a", False, [("-a", "value")]),
        ("x = -1", False, []),
        ("x = not a", False, []),
        ("x = abs(a)", False, [("abs(a)", "value")]),
        ("x = math.sin(a)", False, [("math.sin(a)", "value")]),
        ("x = np.clip(a, 0, 1)", False, [("np.clip(a, 0, 1)", "value")]),
        ("x = 'a%s' % b", False, []),
        ("x = rospy.Time.now()", True, []),
        ("x = self.distance()", True, [("self.distance()", "value")]),
        ("x = 2 * b", False, [("2 * b", "value")]),
        ("x = f(a)", True, [("f(a)", "value")]),
        ("x = f(a)", False, []),
        ("x = Twist(a)", True, []),
        ("x = msg.Twist(a)", True, []),
        ("x = a if b else c", True, [("a if b else c", "value")]),
        ("x = a if b else c", False, []),
        ("x = message.data", True, [("message.data", "input")]),
        ("x = a", True, []),
        ("x: float", True, []),
        ("m.x = a", True, [("a", "stored")]),
        ("m.x = a", False, []),
        ("m[0] = a", True, []),
        ("for i in a: pass", True, []),
        ("out.publish(a + b)", False, [("a + b", "value")]),
        ("out.publish(Float64(data=-a))", False, [("-a", "value")]),
        ("out.publish(Twist(Vector(x=a * 2)))", False, [("a * 2", "value")]),
        ("out.publish(a)", False, [("a", "sent")]),
        ("out.publish(Float64(m.data))", False, [("m.data", "sent")]),
        ("out.publish(a > 1)", False, [("a > 1", "sent")]),
        ("out.publish(f(a))", False, []),
        ("out.send(a)", False, []),
        ("out.send(a + 1)", False, [("a + 1", "value")]),
        ("a", True, []),
    ],
)
def test_each_expression_of_a_statement_has_a_kind(
    text: str, numeric: bool, places: list[tuple[str, str]]
) -> None:
    assert found(text, numeric=numeric) == places


@pytest.mark.parametrize(
    ("text", "sides"),
    [
        ("x = a - b", ["a", "b"]),
        ("x: float = goal.x - self.at['x']", ["goal.x", "self.at['x']"]),
        ("x = k * (a.target - b) + c", ["a.target", "b"]),
        ("x = math.atan2(a.y - b.y, a.x - b.x)", ["a.y", "b.y", "a.x", "b.x"]),
        ("x = a - 1.0", []),
        ("x = a + b", []),
        ("x = a * 2 - b", []),
        ("out.publish(a - b)", []),
        ("x: float", []),
    ],
)
def test_sides_of_a_difference_can_be_tracked(text: str, sides: list[str]) -> None:
    source = document("a.py", text + "\n")
    span = source.span(source.tree.body[0])  # type: ignore[arg-type]
    assert [source.source(side) for side in _sides(source, span)] == sides


def test_calls_of_functions_that_returned_numbers_count_as_arguments() -> None:
    assert found("out.publish(f(a))", returned=("f",)) == [("f(a)", "value")]
    assert found("out.publish(self.f(a), 1)", returned=("g",)) == []


def test_returned_value_is_a_template_place_on_its_own_line() -> None:
    text = "def f(a):\n    b = a + 1\n    return a - 1"
    assert found(text, line=3) == [("a - 1", "value")]
    assert found(text, line=2) == [("a + 1", "value")]
    assert found(text, line=1) == []


@pytest.mark.parametrize(
    ("text", "constants"),
    [
        ("2 * a", {"factor"}),
        ("a / 4", {"factor"}),
        ("-(GAIN * a)", {"factor"}),
        ("a * b * GAIN", {"factor"}),
        ("a + 1", {"term"}),
        ("a - GAIN * b", set()),
        ("a - GAIN", {"term"}),
        ("2 * a + 1", {"term"}),
        ("f(2 * a)", set()),
        ("a * b", set()),
        ("a", set()),
        ("GAIN", set()),
    ],
)
def test_top_level_constants_are_recognised(text: str, constants: set[str]) -> None:
    source = document("a.py", f"x = {text}\n")
    node = source.tree.body[0].value  # type: ignore[attr-defined]
    assert set(constants_of(source, node, {"GAIN"})) == constants


def site(name: str) -> Any:
    return SimpleNamespace(site=SiteId("a", "", name))


A, B, C = site("a"), site("b"), site("c")


def order(*flows: list[Any], culprits: tuple[str, ...] = ()) -> Any:
    sites = [Step(A), Step(B), Step(C)]
    known = {step.site.text: step for step in sites}
    return SimpleNamespace(
        analysis=SimpleNamespace(
            flows=[SimpleNamespace(steps=[known[step.site.text] for step in flow]) for flow in flows],
            sites=sites,
        ),
        comparison=SimpleNamespace(
            culprits=[SimpleNamespace(site=SimpleNamespace(id=f"a:<module>:{name}")) for name in culprits]
        ),
    )


class Step:
    """A statement, compared by identity."""

    def __init__(self, step: Any) -> None:
        self.site = step.site


def test_publish_distance_is_the_shortest_flow() -> None:
    away = _away(order([A, B, C], [A, C]))
    assert {one.text: distance for one, distance in away.items()} == {"a": 1, "b": 1, "c": 0}


@pytest.mark.parametrize(
    ("culprits", "responding", "names"),
    [
        ("b", "", "bca"),
        ("ab", "", "acb"),
        ("", "", "acb"),
        ("ca", "", "cab"),
        ("b", "a", "abc"),
        ("b", "ac", "acb"),
        ("b", "xb", "bca"),
    ],
)
def test_responding_statements_get_templates_first(culprits: str, responding: str, names: str) -> None:
    given = order([A, B, C], culprits=tuple(culprits))
    away = _away(given)  # c, b, a from the publish call backwards
    found = _steps(given, away, [f"a:<module>:{name}" for name in responding])
    assert "".join(step.site.text for step in found) == names


def spot(text: str, kind: str = "value", within: Any = None) -> Spot:
    source = within or document("p.py", TEXT)
    node = next(
        node for node in ast.walk(source.tree) if isinstance(node, ast.expr) and ast.unparse(node) == text
    )
    return Spot(SiteId("a", "", text), source, node, kind, 1.0, 1.0, 0, True)


TEXT = """\
def f():
    a.x = m.p.x
    a.y = m.p.y
    left = one(1)
    right = two(2)
    b.roll = three(3)
    c.pitch = four(4)
    out.send(m.q.x, m.q.z)

def g():
    d = m.r.y
    e = m.r.x
"""


@pytest.mark.parametrize(
    ("first", "second", "paired"),
    [
        ("m.p.x", "m.p.y", True),
        ("m.p.y", "m.p.x", True),
        ("m.q.x", "m.q.z", True),
        ("one(1)", "two(2)", True),  # left and right
        ("three(3)", "four(4)", False),  # of two objects
        ("m.p.x", "m.q.x", False),
        ("m.p.x", "m.q.z", False),
        ("m.p.x", "m.r.y", False),
        ("m.r.y", "m.r.x", True),
        ("m.p.x", "one(1)", False),
    ],
)
def test_values_that_differ_only_in_axis_form_a_pair(first: str, second: str, paired: bool) -> None:
    one, other = spot(first), spot(second)
    assert pairs([one, other], 9) == ([(one, other)] if paired else [])


def test_comparisons_and_values_of_other_files_form_no_pair() -> None:
    assert pairs([spot("m.p.x", "comparison"), spot("m.p.y")], 9) == []
    assert pairs([spot("m.p.x"), spot("m.p.y", within=document("q.py", TEXT))], 9) == []


def test_the_number_of_pairs_is_limited() -> None:
    spots = [spot(text) for text in ("m.p.x", "m.p.y", "m.q.x", "m.q.z")]
    assert len(pairs(spots, 9)) == 2
    assert pairs(spots, 1) == [(spots[0], spots[1])]
    assert pairs(spots, 0) == []


def test_field_built_by_several_statements_changes_at_its_publish_call() -> None:
    text = "def f(self, x):\n    self.m.data = x\n    self.m.data += 0.5\n    self.pub.publish(self.m)\n"
    source = document("a.py", text)
    here = list(_fields(source, Span("a.py", 4, 5, 4, 29)))
    assert [(ast.unparse(node), kind, field) for node, kind, field in here] == [("self.m", "field", "data")]
    assert list(_fields(source, Span("a.py", 3, 5, 3, 23))) == []
