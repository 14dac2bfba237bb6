"""A large change that gains most does not hide a smaller change of another constant."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import distance, offset
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plateau import AROUND, AT_LEAST, best_is_far, inward, nearby
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit, units
from tests.plugin.searching.test_forward_selection import GAINS

UNITS = units(GAINS)


def gains_of(*entries: tuple[Unit, float, float]) -> Gains:
    table = Gains(0.5)
    for unit, factor, gain in entries:
        table.enter((unit, ALWAYS), factor, gain, moved=True)
    return table


@pytest.mark.parametrize(
    ("entries", "far"),
    [
        ([(0, 5.0, 4.0)], True),
        ([(0, 0.15, 4.0)], True),
        ([(0, -1.0, 4.0)], True),
        ([(0, 2.2, 4.0)], False),
        ([(0, 5.0, 4.0), (0, 2.2, 4.0)], False),  # the smaller change gains as much
        ([(0, 5.0, 4.0), (1, 0.4, 3.6)], False),  # the difference may be noise
        ([(0, 5.0, 4.0), (1, 0.4, 3.0)], True),
        ([(0, 5.0, 0.4)], False),
        ([], False),
    ],
)
def test_best_change_is_large_if_no_smaller_one_gains(
    entries: list[tuple[int, float, float]], far: bool
) -> None:
    table = gains_of(*((UNITS[at], factor, gain) for at, factor, gain in entries))
    assert best_is_far(table, ALWAYS) is far


@pytest.mark.parametrize("count", [1, 3, 8])
def test_fewer_constants_get_more_inward_steps(count: int) -> None:
    table = gains_of(*((unit, 5.0, -1.0) for unit in UNITS[:count]))
    matter, steps = inward(UNITS, table)
    assert matter == list(UNITS[:count])
    assert AT_LEAST <= len(steps) <= max(AT_LEAST, AROUND // count)
    assert len(set(steps)) == len(steps)
    assert all(0.4 < step < 2.2 for step in steps)


def test_narrow_range_is_found_despite_a_large_gain() -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        factors = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
        right = abs(factors.get(GAINS[2], 1.0) - 1.33) < 0.04
        around = 5.0 <= factors.get(GAINS[5], 1.0) < 6.0
        touched = 0.01 * len(factors.keys() & {GAINS[0], GAINS[2], GAINS[5]})
        total = 10.0 if right else 6.0 if around else -touched
        return Outcome(total, total > 5.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.5, online=0.0)
    trials = Trials(run, 300)
    found = next(Sweep(GAINS, mutations, (ALWAYS,), trials, goal).candidates())
    assert [mutation.operand for mutation in found.mutations] == [GAINS[2]]
    assert trials.spent < 130


@pytest.mark.parametrize(
    ("entries", "expected"),
    [
        ([(0, 5.0, 9.0), (1, 1.5, 8.0), (2, 0.4, 3.9)], [1]),  # a large change gains most
        ([(0, 5.0, 9.0), (1, 1.5, 8.9)], [1]),
        ([(0, 2.2, 9.0), (1, 1.5, 8.0), (2, 5.0, 8.5)], []),  # it does not
        ([(0, 5.0, 9.0), (1, 0.15, 8.0)], []),
        ([], []),
    ],
)
def test_good_smaller_changes_are_refined_first(
    entries: list[tuple[int, float, float]], expected: list[int]
) -> None:
    table = gains_of(*((UNITS[at], factor, gain) for at, factor, gain in entries))
    tried = [key for key, _ in table.items()]
    assert nearby(tried, table, 4.0) == [(UNITS[at], ALWAYS) for at in expected]


def test_small_change_is_found_despite_a_large_one() -> None:
    """A robot drives by the clock on worn tyres: it must drive for a third longer, or by chance five times as fast."""
    wait, speed = GAINS[2], GAINS[0]

    def run(candidate: Candidate, _: int) -> Outcome:
        factors = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
        late, fast = abs(factors.get(wait, 1.0) - 1.34), factors.get(speed, 1.0)
        total = (
            10.0 - 25.0 * late
            if late < 0.2
            else 8.0
            if 4.9 < fast < 5.5
            else 3.0
            if 2.0 < fast < 3.0
            else 0.0
        )
        return Outcome(total - 0.01 * len(factors), total > 9.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.4, online=0.0)
    trials = Trials(run, 300)
    found = next(Sweep(GAINS, mutations, (ALWAYS,), trials, goal).candidates())
    assert [mutation.operand for mutation in found.mutations] == [wait]
    assert trials.spent < 100


@pytest.mark.parametrize(("factor", "far"), [(1.2, False), (0.5, True), (3.0, True)])
def test_offset_is_far_if_it_changes_by_a_large_factor(factor: float, far: bool) -> None:
    """The steps of an offset of 0.1 in a sum of numbers around 1 are much larger than the offset."""
    unit = Unit(UNITS[0].operands, offset(1.0))
    value = float(UNITS[0].operands[0].value or 0.0)
    assert (not 0.4 <= 1.0 + distance(factor) / value <= 2.5) is far
    assert best_is_far(gains_of((unit, factor, 4.0)), ALWAYS) is far


def test_inward_steps_prefer_named_constants() -> None:
    literal = UNITS[0]
    named = Unit((replace(GAINS[1], code="GAIN", definition=GAINS[7].span),))
    both = (literal, named)
    assert inward(both, gains_of((literal, 2.2, 1.0), (named, 2.2, 1.0)))[0] == [named]
    assert inward(both, gains_of((literal, 2.2, 1.0)))[0] == [literal]
