"""A value at the end of the range of good values moves towards its middle; other values stay."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.repairing.good_range import PROBES, SEEDS, GoodRange, rounded
from pytest_tarl.searching.accept import Outcome, Reference
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import operand

REFERENCE = Reference((10.0, 10.0), 1.0, 0.5, 0.0)
GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.5, online=0.0, passing=True)
GAIN = replace(operand(4, "GAIN", 2.0), definition=operand(1, "2.0", 2.0).span)


def changed(by: float) -> Candidate:
    made = mutations(GAIN, by)
    assert made is not None
    return Candidate((made,), ALWAYS)


def world(low: float, high: float, slope: float = 0.0) -> Trials:
    """Return a world in which the factors between two bounds pass; they earn more by `slope` the larger they are."""

    def run(candidate: Candidate, _: int) -> Outcome:
        by = factor(candidate.mutations[0]) or 0.0
        good = low < by < high
        return Outcome(10.0 + slope * (by - high) if good else 0.0, good)

    return Trials(run, 100)


def moved(trials: Trials, by: float) -> float:
    found = GoodRange(mutations).amid(changed(by), trials, GOAL, REFERENCE)
    return factor(found.mutations[0]) or 0.0


@pytest.mark.parametrize(
    ("low", "high", "by"),
    [(0.2, 0.8, 0.78), (0.2, 0.8, 0.21), (1.1, 4.0, 1.15), (1.1, 4.0, 3.9), (1.05, 1.5, 1.07)],
)
def test_a_value_at_an_end_moves_inside_the_range(low: float, high: float, by: float) -> None:
    trials = world(low, high)
    for tried in (2.2, 0.4, 5.0, 0.15):  # the search has tried large steps
        trials(changed(tried), 0)
    begun = trials.spent
    assert low * 1.04 < moved(trials, by) < high / 1.04
    assert trials.spent - begun <= PROBES + 2 * SEEDS


@pytest.mark.parametrize(("low", "high", "by"), [(1.5, 6.0, 3.0), (0.2, 0.8, 0.4), (1.5, 1e9, 2.2)])
def test_a_value_inside_the_range_stays(low: float, high: float, by: float) -> None:
    trials = world(low, high)
    for tried in (1.2, 10.0, 0.9, 0.1, 2.6, 0.5):
        trials(changed(tried), 0)
    begun = trials.spent
    assert moved(trials, by) == pytest.approx(by)
    assert trials.spent - begun <= 1


def test_value_stays_if_inner_values_earn_less() -> None:
    trials = world(1.1, 4.0, slope=1.0)
    for tried in (1.05, 4.2):
        trials(changed(tried), 0)
    assert moved(trials, 3.9) == pytest.approx(3.9)


def test_hardest_seed_shows_where_the_range_ends() -> None:
    trials = world(1.5, 1e9)
    trials.misses[3] = 2
    moved(trials, 2.2)
    assert [seed for outcomes in trials.alike(changed(2.2)).values() for seed in outcomes] == [3]


def test_a_constant_is_moved_once() -> None:
    ranges, trials = GoodRange(mutations), world(0.2, 0.8)
    for tried in (0.9, 0.15):
        trials(changed(tried), 0)
    first = ranges.amid(changed(0.78), trials, GOAL, REFERENCE)
    assert first != changed(0.78)
    assert ranges.amid(changed(0.79), trials, GOAL, REFERENCE) == changed(0.79)


def test_the_new_value_has_few_digits() -> None:
    found = GoodRange(mutations).amid(changed(0.78), world(0.2, 0.8), GOAL, REFERENCE)
    value = 2.0 * float(found.mutations[0].value)
    assert value == pytest.approx(rounded(value, 0.0), abs=1e-9)
    assert len(f"{value:.6g}") <= 4


@pytest.mark.parametrize("value", [-2.0, True])
def test_a_changed_sign_or_boolean_is_not_moved(value: float) -> None:
    constant = operand(5, "False", False) if value is True else GAIN
    found, trials = Candidate((Mutation(constant, value),), ALWAYS), world(0.0, 9.0)
    assert GoodRange(mutations).amid(found, trials, GOAL, REFERENCE) == found
    assert trials.spent == 0


@pytest.mark.parametrize(
    ("value", "tolerance", "short"), [(0.0008347, 0.1, 0.0008), (2137.6, 0.01, 2140.0), (3.186, 0.0, 3.186)]
)
def test_a_value_is_rounded_within_the_tolerance(value: float, tolerance: float, short: float) -> None:
    assert rounded(value, tolerance) == pytest.approx(short, rel=1e-12)
