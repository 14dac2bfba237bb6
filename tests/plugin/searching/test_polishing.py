"""A combination that earns nearly enough is adjusted before the search goes elsewhere."""

from __future__ import annotations

import math

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.polishing import EPISODES, Factors, polished
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_forward_selection import operand

BEST = (0.6, 1.5)


def earned(factors: Factors, seed: int) -> float | None:
    away = sum(abs(math.log(one / best)) for one, best in zip(factors, BEST, strict=True))
    return None if away > 1.0 else 10.0 - 4.0 * away + 0.01 * seed


def mean(factors: Factors) -> float:
    return sum(earned(factors, seed) or 0.0 for seed in range(3)) / 3


@pytest.mark.parametrize("begin", [(0.75, 1.5), (0.6, 1.2), (0.5, 1.9)])
def test_polishing_moves_factors_to_the_best_values_nearby(begin: Factors) -> None:
    found = polished(begin, earned, range(8), 17.0)
    assert mean(found) > mean(begin)
    assert all(one == pytest.approx(best, rel=0.08) for one, best in zip(found, BEST, strict=True))


def test_polishing_leaves_the_best_factors() -> None:
    assert polished(BEST, earned, range(8), 17.0) == BEST
    assert polished((6.0, 1.5), earned, range(8), 17.0) == (6.0, 1.5)


def on_a_ridge(factors: Factors, _: int) -> float | None:
    """Two factors compensate each other: missions fail unless their product is near 1, and earn most at (2, 0.5)."""
    one, other = map(math.log, factors)
    away, apart = abs(one + other), one - other - 2.0 * math.log(2.0)
    return None if away > 0.1 else 10.0 - apart**2 - 1.2 * away


def test_factors_that_compensate_each_other_move_together() -> None:
    stuck = (1.458, 0.6858)  # one factor after the other leads from `begin` to this point, and no further
    begin, moves = (1.25, 0.8), (1.08, 1 / 1.08)
    beside = [(stuck[0] * by, stuck[1]) for by in moves] + [(stuck[0], stuck[1] * by) for by in moves]
    assert all((on_a_ridge(one, 0) or 0.0) < (on_a_ridge(stuck, 0) or 0.0) for one in beside)
    assert polished(begin, on_a_ridge, range(8), 10.0, (1.08,)) == pytest.approx((2.0, 0.5), rel=0.02)


def test_factors_that_compensate_each_other_stay_on_a_plateau() -> None:
    def flat(factors: Factors, seed: int) -> float | None:
        total = on_a_ridge(factors, seed)
        return None if total is None else min(total, 9.9) + 1e-4 * factors[0]

    assert polished((1.25, 0.8), flat, range(8), 10.0, (1.08,))[0] < 1.9


def test_adjusting_ends_as_soon_as_the_mean_is_enough() -> None:
    ran: list[Factors] = []

    def recorded(factors: Factors, seed: int) -> float | None:
        ran.append(factors)
        return earned(factors, seed)

    found = polished((0.3, 1.5), recorded, range(8), 17.0, enough=8.5)
    assert 8.5 <= mean(found) < 10.0
    few = len(ran)
    polished((0.3, 1.5), recorded, range(8), 17.0)
    assert few < len(ran) - few


def test_adjusting_ends_after_a_number_of_episodes() -> None:
    ran: list[Factors] = []

    def endless(factors: Factors, seed: int) -> float:
        ran.append(factors)
        return math.prod(factors)

    polished((1.0, 1.0, 1.0), endless, range(8), 1.0)
    assert EPISODES <= len(ran) < EPISODES + 3


GRIP, ANGLE, IDLE = (Unit((operand(line, "1.0", 1.0),)) for line in (3, 4, 5))


def selection(budget: int = 300) -> ForwardSelection:
    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {Unit((one.operand,)): float(one.value) for one in candidate.mutations}
        total = earned((by.get(GRIP, 1.0), by.get(ANGLE, 1.0)), 0)
        return Outcome(-7.0, False) if total is None else Outcome(total, total > 8.0)

    pairs = tuple(Pair(seed, -7.0) for seed in range(8))
    goal = Goal(pairs, near=8.5, enough=9.4, online=-7.0, passing=True)
    return ForwardSelection((GRIP, ANGLE, IDLE), mutations, Trials(run, budget), goal, {}, 0.1)


def test_nearly_sufficient_pair_is_adjusted() -> None:
    joint = Joint(((GRIP, 0.75), (ANGLE, 1.5), (IDLE, 0.9)), ALWAYS)
    search = selection()
    (found,) = list(search.gain(joint))
    assert {one.operand for one in found.mutations} == {GRIP.operands[0], ANGLE.operands[0]}
    assert found.mutations[0].value == pytest.approx(0.6, rel=0.08)
    assert not list(search.gain(Joint(((GRIP, 0.8), (ANGLE, 1.5)), ALWAYS)))  # each combination only once


def test_barely_sufficient_pair_is_adjusted() -> None:
    first, better = list(selection().gain(Joint(((GRIP, 0.66), (ANGLE, 1.5)), ALWAYS)))
    assert first.mutations[0].value == 0.66
    assert better.mutations[0].value == pytest.approx(0.6, rel=0.08)


def test_refused_harmful_pair_is_not_adjusted() -> None:
    search = selection()
    search.trials.harms = lambda candidate: len(candidate.mutations) == 2
    assert len(list(search.gain(Joint(((GRIP, 0.66), (ANGLE, 1.5)), ALWAYS)))) == 1


def test_more_than_sufficient_pair_is_not_adjusted() -> None:
    assert len(list(selection().gain(Joint(((GRIP, 0.61), (ANGLE, 1.5)), ALWAYS)))) == 1


def test_a_pair_whose_missions_fail_is_not_adjusted() -> None:
    search = selection()
    assert not list(search.gain(Joint(((GRIP, 0.4), (ANGLE, 1.5)), ALWAYS)))
    assert search.trials.spent == 1


def narrow(width: float) -> ForwardSelection:
    """Return a selection in a world where only grips near 0.6 earn anything; hard seeds need a closer one."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        (change,) = candidate.mutations
        away = abs(math.log(float(change.value) / 0.6))
        passed = away < width / (1 + seed)
        return Outcome(10.0 if passed else 10.0 - 60.0 * away, passed)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.5, enough=9.5, online=0.0, passing=True)
    return ForwardSelection((GRIP,), mutations, Trials(run, 300), goal, {}, 0.1)


def test_constant_that_fails_on_hard_seeds_is_adjusted_there() -> None:
    search = narrow(0.05)
    near = Joint(((GRIP, 0.628),), ALWAYS).candidate(mutations)
    totals = [search.trials(near, seed).total for seed in range(3)]
    assert min(totals) < 9.5 <= max(totals)
    (found,) = list(search.sharpened(GRIP, 0.628, ALWAYS))
    assert found.mutations[0].value == pytest.approx(0.6, rel=0.0125)
    assert all(search.trials(found, seed).passed for seed in range(4))


@pytest.mark.parametrize(("factor", "seeds"), [(0.628, 2), (0.58, 0), (1.5, 3)])
def test_rarely_run_constant_is_not_adjusted(factor: float, seeds: int) -> None:
    search = narrow(0.05)
    candidate = Joint(((GRIP, factor),), ALWAYS).candidate(mutations)
    for seed in range(seeds):
        search.trials(candidate, seed)
    assert not list(search.sharpened(GRIP, factor, ALWAYS))
    assert search.trials.spent == seeds
