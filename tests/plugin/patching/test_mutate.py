"""Mutations of constants: new values at their uses, steps on a scale, and numbers at definitions."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pytest_tarl.patching.charts import SHARE, offset
from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.mutate import (
    Mutation,
    form_values,
    is_integral,
    mutations,
    redefinition,
    step_of,
    stepped,
    to_step,
)
from pytest_tarl.patching.structures import Form
from tarl_lint.model import Operand, SiteId, Span
from tests.plugin.patching.repairs import HandMade

SPAN = Span("node.py", 1, 1, 1, 2)


def constant(value: Any, literal: bool = True) -> Operand:
    return Operand(SiteId("node", "", ""), SPAN, "k", value, SPAN if literal else None)


@pytest.mark.parametrize(
    ("value", "factor", "expected"),
    [
        (0.5, 2.2, 1.1),
        (5, 2.4, 12),
        (5, 2.35, 11.75),
        (3.0, 1 / 3, 1.0),
        (0.123456, 2, 0.2469),
        (-0.5, 2, -1.0),
        (0, 2.2, 1.2),
        (0.0, 0.4, -1.5),
        (True, 2.2, False),
        (False, 0.4, True),
    ],
)
def test_a_literal_takes_the_scaled_value_with_four_digits(value: Any, factor: float, expected: Any) -> None:
    found = mutations(constant(value), factor)
    assert found is not None
    assert (found.value, type(found.value)) == (expected, type(expected))


@pytest.mark.parametrize(
    ("value", "factor", "expected"), [(5, 2.35, 12), (1, 1.2, 2), (1, 0.9, 0), (10, 0.04, 0)]
)
def test_integer_count_changes_by_at_least_one(value: int, factor: float, expected: int) -> None:
    assert mutations(constant(value), factor, integral=True) == Mutation(constant(value), expected)


@pytest.mark.parametrize("value", [5, 0.5, 0, 0.0, 7.12345])
@pytest.mark.parametrize("integral", [False, True])
def test_a_factor_that_changes_nothing_gives_no_mutation(value: float, integral: bool) -> None:
    found = mutations(constant(value), 1.0, integral)
    assert found is None or (value == 7.12345 and found.value == 7.123)


@pytest.mark.parametrize(
    ("value", "factor"), [(math.inf, 2.0), (math.nan, 2.0), (1.0, math.inf), (1e308, 10.0)]
)
def test_infinite_values_give_no_mutation(value: float, factor: float) -> None:
    assert mutations(constant(value), factor) is None


@pytest.mark.parametrize(
    ("value", "factor", "expected"), [(0.5, 2.2, 2.2), (None, 0.4, 0.4), (0.0, 2.2, 1.2), (True, 3.0, False)]
)
def test_named_constant_is_scaled_or_moved_at_its_use(value: Any, factor: float, expected: Any) -> None:
    found = mutations(constant(value, literal=False), factor)
    assert found is not None
    assert found.value == expected


def test_zero_steps_are_symmetric_on_a_log_scale() -> None:
    up, down = mutations(constant(0.0), 4.0), mutations(constant(0.0), 0.25)
    assert up is not None
    assert down is not None
    assert up.value == -down.value == 3.0


@pytest.mark.parametrize(
    ("code", "integral"),
    [
        ("a[5]", True), ("a[1:5]", True), ("a[i + 5]", True), ("range(5)", True), ("x == 5", True), ("x << 5", True),
        ("Publisher(queue_size=5)", True), ("'-' * 5", True), ("[0] * 5", True), ("x in (5, 2)", True),
        ("paint((5, 0, 255))", True),
        ("array([-5, 2])", True), ("f([5, 0.5])", False), ("f(k=(5, 2))", False), ("y = [5, 2]", False),
        ("5 * x", False), ("x > 5", False), ("f(5)", False), ("x % 5", False), ("a[x] * 5", False), ("x / 5", False),
    ],
)  # fmt: skip
def test_places_that_need_integers_are_recognised(code: str, integral: bool) -> None:
    analysis = HandMade({"node.py": f"y = {code}\n"})
    assert is_integral(analysis, analysis.operand("5", 5, "5")) is integral


def made_at(value: Any, share: float = 1.0) -> Place:
    return Place("params.yaml", 0, 1, 1, "k", value, share)


@pytest.mark.parametrize(
    ("mutation", "expected"),
    [
        (Mutation(constant(0.5), 1.25), 1.25),  # a literal is replaced
        (Mutation(constant(True), 2.0), False),
        (Mutation(constant(False, literal=False), 2.0, made_at(False)), True),
        (Mutation(constant(0.5, literal=False), 3.0), 1.5),  # other constants are scaled
        (Mutation(constant(0.5, literal=False), 3.0, made_at(2.0)), 6.0),
        (Mutation(constant(None, literal=False), 3.0, made_at(2.0)), 6.0),
        (Mutation(constant(None, literal=False), 3.0, made_at(True)), False),
        (Mutation(constant(0.0, literal=False), 0.7, made_at(0.0)), 0.7),  # a zero is moved
        (Mutation(constant(None, literal=False), 0.7, made_at(0)), 0.7),
        # a number that makes a quarter of the change moves four times as far: 2 · (1 + 2 · 4)
        (Mutation(constant(0.5, literal=False), 3.0, made_at(2.0, 4.0)), 18.0),
        (Mutation(constant(0.5, literal=False), 0.5, made_at(2.0, -2.0)), 4.0),
    ],
)  # fmt: skip
def test_definition_follows_the_change_at_the_use(mutation: Mutation, expected: Any) -> None:
    found = redefinition(mutation)
    assert (found, type(found)) == (pytest.approx(expected), type(expected))


def test_step_on_a_scale_has_a_matching_factor() -> None:
    share = constant(0.9)
    made = stepped(share, 5.0, SHARE, mutations)  # the distance from 1 becomes a fifth
    assert made is not None
    assert (made.value, made.chart) == (0.98, SHARE)
    assert step_of(made) == pytest.approx(5.0)
    named = stepped(constant(0.9, literal=False), 5.0, SHARE, mutations)
    assert named is not None
    assert named.value == pytest.approx(0.98 / 0.9, rel=1e-3)
    assert step_of(named) == pytest.approx(5.0, rel=0.02)
    moved = stepped(constant(-0.5), 5.0, offset(0.25), mutations)  # four times the size is added
    assert moved is not None
    assert (moved.value, step_of(moved)) == (0.5, pytest.approx(5.0))
    zero = stepped(constant(0.0), 5.0, offset(0.25), mutations)
    assert zero is not None
    assert (zero.value, step_of(zero)) == (1.0, pytest.approx(5.0))


def test_step_without_a_scale_is_a_factor() -> None:
    plain = stepped(constant(0.9), 2.0, None, mutations)
    assert plain == mutations(constant(0.9), 2.0)
    assert plain is not None
    assert step_of(plain) is None
    unknown = stepped(constant(None, literal=False), 2.0, SHARE, mutations)
    assert unknown is not None
    assert (unknown.value, unknown.chart) == (2.0, None)
    assert stepped(constant(0.9), -1.0, SHARE, mutations) is None
    assert stepped(constant(0.9), 1.0, SHARE, mutations) is None  # changes nothing


def test_another_step_keeps_operand_and_scale() -> None:
    first = stepped(constant(0.9), 5.0, SHARE, mutations)
    assert first is not None
    other = to_step(first, 10.0, mutations)
    assert other is not None
    assert (other.value, other.chart, other.operand) == (0.99, SHARE, first.operand)
    template: Any = object()
    formed = Mutation(constant(0.9), 2.0, form=Form(template, "gain", (("gain", 0.3), ("rest", 5.0))))
    again = to_step(formed, 4.0, mutations)
    assert again is not None
    assert (again.value, again.form) == (4.0, formed.form)
    assert form_values(again) == {"gain": pytest.approx(1.2), "rest": 5.0}
    assert form_values(first) == {}
    bare = Mutation(constant(0.9), 2.0, form=Form(template, "", (("gain", 0.3),)))
    assert form_values(bare) == {"gain": 0.3}
