"""Among repairs that hold, prefer what a maintainer would write: factors before offsets, names before literals."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.charts import SHARE, offset
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.plainness import Oddness, edges, instead_of_offset, is_sign, oddness, writing
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from pytest_tarl.sensors import Sensor
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

OFFSET, INNER = operand(3, "0.0", 0.0), operand(4, "2.5", 2.5)
NAMED = replace(operand(5, "GAIN", 2.0), definition=operand(1, "2.0", 2.0).span)
SIGN = replace(operand(9, "self._sign_throttle", 1), definition=operand(2, "1", 1).span)
POSITION = Sensor("pos", topic="/odom", field="x", low=0, high=10, bins=10)


@pytest.mark.parametrize(
    ("mutation", "expected"),
    [
        (Mutation(OFFSET, 1.2), Oddness.OFFSET),
        (Mutation(NAMED, -1.0), Oddness.OFFSET),
        (Mutation(INNER, -2.5), Oddness.OFFSET),
        (Mutation(INNER, 5.0), Oddness.INNER),
        (Mutation(NAMED, 2.2), Oddness.NAMED),
        (Mutation(replace(operand(7, "goal", 1.0), value=None, definition=None), 2.2), Oddness.VARIABLE),
        (
            Mutation(replace(operand(8, "gain", 1.0), value=None, definition=None, setting="gain"), 2.2),
            Oddness.NAMED,
        ),
        (Mutation(operand(6, "True", True), value=False), Oddness.INNER),
        (Mutation(SIGN, 1.48), Oddness.OFFSET),
        (Mutation(SIGN, -1.0), Oddness.NAMED),
        (Mutation(replace(SIGN, code="designed"), 1.48), Oddness.NAMED),
        (Mutation(replace(SIGN, value=2), 1.48), Oddness.NAMED),
    ],
)
def test_each_change_has_the_expected_readability_rank(mutation: Mutation, expected: Oddness) -> None:
    assert oddness([mutation]) == expected
    assert oddness([Mutation(NAMED, 2.2), mutation]) == expected


@pytest.mark.parametrize(
    ("code", "value", "sign"),
    [
        ("LEFT_SIGN", -1, True),
        ("motorDirection", 1.0, True),
        ("self.polarity", -1, True),
        ("signal", 1, False),
        ("resigned", 1, False),
        ("direction", 2, False),
        ("inverted", True, False),
    ],
)
def test_constant_one_with_a_sign_name_is_a_sign(code: str, value: float, sign: bool) -> None:
    assert is_sign(replace(SIGN, code=code, value=value)) == sign


def test_only_numeric_conditions_have_a_threshold() -> None:
    wet = Sensor("wet", topic="/wet", field="data")
    assert edges(Guard((Conjunct(wet, 1, 1), Conjunct(POSITION, 4, math.inf)))) == ("pos",)
    assert edges(Guard((Conjunct(POSITION, -math.inf, math.inf),))) == ()


def restoring(
    right: dict[Operand, float],
    window: float,
    harm: float = 0.0,
    guards: tuple[Guard, ...] = (ALWAYS,),
    helpers: tuple[Operand, ...] = (),
) -> Sweep:
    """A world in which each of several operands alone restores the reward, within a window around its right factor.

    No condition can be written at the operands of `helpers`.
    """

    def run(candidate: Candidate, seed: int) -> Outcome:
        if candidate.guard.conjuncts and any(one.operand in helpers for one in candidate.mutations):
            raise RepairError("Sensor 'pos' cannot be read there.")
        noise = float(np.random.default_rng(seed).normal(0, 0.05))
        total = 0.0
        for mutation in candidate.mutations:
            of = mutation.operand
            value = float(mutation.value)
            factor = 1 + value if of.value == 0 else value / float(of.value or 1) if of.literal else value
            off = abs(math.log(max(factor, 1e-3) / right[of])) if of in right and factor > 0 else 9.0
            total = (
                max(total, 10.0)
                if off < window
                else total - harm
                if of not in right or off > window
                else total
            )
        return Outcome(total + noise, total > 5)

    pairs = tuple(Pair(seed, run(Candidate((), ALWAYS), seed).total) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=0.0, passing=True)
    filler = tuple(operand(at, f"{at}.0", float(at)) for at in range(20, 26))
    return Sweep(
        (*sorted(right, key=lambda one: one.span), *filler), mutations, guards, Trials(run, 300), goal
    )


def test_factor_is_tried_before_an_offset() -> None:
    found = restoring({OFFSET: 2.2, NAMED: 0.42}, window=0.2).candidates()
    assert next(found).mutations[0].operand == NAMED


def test_named_constants_get_moderate_steps_before_literals() -> None:
    search = restoring({INNER: 2.2, NAMED: 0.65}, window=0.1, harm=0.3)
    assert next(search.candidates()).mutations[0].operand == NAMED
    assert not any("→" in label for label in search.attempts.trials.labels)


def test_named_constant_of_a_helper_comes_before_a_literal() -> None:
    far = Guard((Conjunct(POSITION, 5, math.inf),))
    found = restoring(
        {INNER: 2.2, NAMED: 2.2}, window=0.2, guards=(far, ALWAYS), helpers=(NAMED,)
    ).candidates()
    first, second = (next(found) for _ in range(2))
    assert (first.mutations[0].operand, first.guard) == (NAMED, ALWAYS)
    assert second.mutations[0].operand == INNER


def test_offset_is_accepted_early_without_alternatives() -> None:
    search = restoring({OFFSET: 2.2}, window=0.2)
    assert next(search.candidates()).mutations[0].operand == OFFSET
    assert search.attempts.trials.spent < 30


@settings(max_examples=25, deadline=None)
@given(factor=st.floats(1.35, 1.7), smaller=st.booleans())
def test_a_narrow_window_near_the_original_is_found_soon(factor: float, smaller: bool) -> None:
    """Units that lose at both 2.2 and 0.4 get smaller steps at once, before others get larger ones."""
    right = 1 / factor if smaller else factor
    search = restoring({NAMED: right}, window=0.14, harm=3.0)
    found = next(search.candidates())
    assert found.mutations[0].operand == NAMED
    assert search.attempts.trials.spent <= 60


def test_ineffective_named_constant_comes_before_a_literal() -> None:
    early = replace(NAMED, span=replace(NAMED.span, line=2, end_line=2))
    found = restoring({early: 4.0, INNER: 2.2}, window=0.3).candidates()
    assert [next(found).mutations[0].operand for _ in range(2)] == [early, INNER]


def test_named_constants_are_tried_before_literals_and_zeros_last() -> None:
    named_zero = replace(operand(6, "TRIM", 0.0), definition=operand(1, "0.0", 0.0).span)
    unknown = replace(operand(7, "self.k", None), definition=None)
    flag = operand(8, "False", False)
    ordered = sorted([OFFSET, INNER, named_zero, flag, NAMED, unknown], key=writing)
    assert ordered == [NAMED, INNER, named_zero, flag, unknown, OFFSET]


def beside(code: str, value: float, name: str = "") -> Unit:
    """Return a constant of the statement that contains OFFSET; with a `name`, a named one."""
    made = replace(operand(3, code, value), site=OFFSET.site)
    return Unit((replace(made, code=name, definition=operand(1, code, value).span) if name else made,))


LIMIT, TRIM, FACTOR = beside("24.0", 24.0), beside("0.0", 0.0, "TRIM"), beside("3.0", 3.0, "FACTOR")
CHARTED = Unit(TRIM.operands, offset(0.5))


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        ((LIMIT,), [(LIMIT, 1.5), (LIMIT, 0.5)]),
        ((LIMIT, FACTOR, TRIM), [(TRIM, 13.0), (TRIM, 1 / 13), (FACTOR, 5.0), (LIMIT, 1.5), (LIMIT, 0.5)]),
        ((CHARTED,), [(CHARTED, 25.0), (CHARTED, 1 / 25)]),
        ((Unit((OFFSET,)), beside("0", 0), Unit((INNER,)), beside("True", True)), []),
        ((Unit(LIMIT.operands, SHARE),), []),
    ],
)
def test_offset_moves_named_zeros_first(units: tuple[Unit, ...], expected: list[tuple[Unit, float]]) -> None:
    found = instead_of_offset(Candidate((Mutation(OFFSET, 12.0),), ALWAYS), units)
    assert [unit for unit, _ in found] == [unit for unit, _ in expected]
    assert [step for _, step in found] == pytest.approx([step for _, step in expected])


def test_only_a_single_offset_is_moved_to_other_constants() -> None:
    both = Candidate((Mutation(OFFSET, 12.0), Mutation(INNER, 5.0)), ALWAYS)
    assert instead_of_offset(both, [LIMIT]) == []
    assert instead_of_offset(Candidate((Mutation(INNER, 5.0),), ALWAYS), [LIMIT]) == []


def test_threshold_moves_by_an_equivalent_offset() -> None:
    limit, since = (
        operand(3, "24.0", 24.0),
        replace(operand(3, "since", 0.0), definition=operand(1, "0.0", 0.0).span),
    )
    units = replace(limit, site=since.site), since

    def run(candidate: Candidate, _: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        least = by.get(units[0], 24.0) + by.get(since, 0.0)
        return Outcome(10.0 if 28.0 < least < 40.0 else 0.0, 28.0 < least < 40.0, steps=round(least))

    goal = Goal(
        tuple(Pair(seed, 0.0, 24) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True
    )
    attempts = Attempts((Unit((units[0],)), Unit((since,))), mutations, (ALWAYS,), Trials(run, 100), goal)
    found = next(attempts.attempt(Unit((since,)), ALWAYS, 12.6, 0))
    assert [one.operand for one in found.mutations] == [units[0]]
