"""Which alternatives to a change are tried, with which factors, and where their limits lie."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import exp, inf, log
from typing import Any

import pytest

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.acting import CHANGES, SEEDS, Acting
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.closeness import rivals
from pytest_tarl.searching.closest_factor import LEAST, MOST, STRONGER, WEAKER, nearest
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.gentler import COARSE, FINE, another_way, gentler
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.smaller import LEADING, OTHERS, STEPS, inside, milder, onward, smaller
from pytest_tarl.searching.units import Unit
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_gains import constant
from tests.plugin.searching.test_search import operand

WET = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1),))
A, B, C, D = (Unit((constant(line, name),)) for line, name in enumerate("ABCD", 1))
LITERAL = Unit((operand(9, "1.5", 1.5),))


def entered(*tries: tuple[Unit, float, float], guard: Guard = ALWAYS, **given: Any) -> Gains:
    found = Gains(0.1, **given)
    for unit, factor, gain in tries:
        found.enter((unit, guard), factor, gain)
    return found


# nearest


def fitted(
    power: float, slopes: tuple[float, float] = (1.0, 1.0), factor: float = 2.0
) -> tuple[Any, list[float]]:
    """Return the factor found, and the exponents asked, for a deviation with its minimum at an exponent."""
    asked: list[float] = []

    def deviation(one: float) -> float:
        at = log(one) / log(factor)
        asked.append(round(at, 3))
        return slopes[0] * max(power - at, 0.0) + slopes[1] * max(at - power, 0.0)

    return nearest(factor, deviation)[0], asked


def test_minimum_lies_where_both_lines_meet() -> None:
    assert fitted(0.8) == (pytest.approx(2**0.8, rel=1e-3), [1.0, WEAKER, 0.8])
    assert fitted(1.2) == (pytest.approx(2**1.2, rel=1e-3), [1.0, WEAKER, STRONGER, 1.2])


def test_minimum_beyond_an_exponent_is_found() -> None:
    assert fitted(0.4)[0] == pytest.approx(2**0.4, rel=1e-3)
    assert len(fitted(0.4)[1]) == 4
    assert fitted(1.8)[0] == pytest.approx(2**1.8, rel=1e-3)
    assert len(fitted(1.8)[1]) == 5


def test_the_exponent_stays_within_its_limits() -> None:
    assert fitted(-3.0)[1][-1] == pytest.approx(LEAST, abs=2e-3)
    assert fitted(9.0)[1][-1] == pytest.approx(MOST, abs=2e-3)


def test_factor_is_kept_without_a_better_exponent() -> None:
    assert fitted(1.0) == (2.0, [1.0, WEAKER, STRONGER])
    assert fitted(0.98)[0] == pytest.approx(2.0, rel=0.02)
    assert nearest(2.0, lambda _: 3.0) == (2.0, 3.0)
    assert nearest(2.0, lambda _: inf) == (2.0, inf)


def test_exponent_nearest_to_one_wins_a_tie() -> None:
    values = iter([1.0, 0.5, 0.5, 0.5])
    found, least = nearest(2.0, lambda _: next(values))
    assert found == pytest.approx(2**0.8, rel=1e-3)
    assert least == 0.5


# acting


def published(
    units: dict[Unit, Any], **given: Any
) -> tuple[Acting, Trials, Callable[[Unit, float, int], None]]:
    """Return the comparison, its trials, and a function that runs a change; `units` maps a constant to its messages."""
    of = {unit.operands[0]: value for unit, value in units.items()}

    def run(candidate: Candidate, seed: int) -> Outcome:
        (change,) = candidate.mutations
        return Outcome(0.0, False, outputs=of[change.operand])

    usual = {"unchanged": lambda seed: Outcome(0.0, False, outputs=(("/a", (1.0, 1.0)),))}
    trials = Trials(run, 100, **(usual | given))
    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(10)), near=9.0, enough=9.5, online=0.0)
    acting = Acting(trials, goal)

    def ran(unit: Unit, factor: float, seed: int) -> None:
        candidate = Candidate(unit.mutations(mutations, factor), ALWAYS)
        trials(candidate, seed)
        acting.ran(unit, candidate)

    return acting, trials, ran


SAME, OTHER = (("/a", (1.0, 1.0)),), (("/a", (1.0, 1.5)),)


def test_messages_are_compared_on_the_first_seeds() -> None:
    acting, trials, ran = published({A: OTHER, B: OTHER, C: OTHER})
    ran(A, 2.2, SEEDS - 1)
    ran(B, 2.2, SEEDS)
    for number in range(CHANGES):
        ran(C, 2.0 + number, SEEDS)
    ran(C, 50.0, 0)
    assert [acting(one) for one in (A, B, C)] == [True, False, False]
    assert trials.beside == 1


def test_equal_or_unknown_messages_show_no_effect() -> None:
    acting, trials, ran = published({A: SAME, B: ()})
    ran(A, 2.2, 0)
    ran(B, 2.2, 1)
    assert not acting(A)
    assert not acting(B)
    assert trials.beside == 1  # nothing is compared with unknown messages
    acting, trials, ran = published({A: OTHER}, unchanged=None)
    ran(A, 2.2, 0)
    assert not acting(A)
    assert trials.beside == 0


# gentler


def way(lengths: tuple[int | None, ...], designed: float | None) -> bool:
    trials = Trials(lambda _, seed: Outcome(1.0, True, steps=lengths[seed]), 10)
    candidate = Candidate(A.mutations(mutations, 2.0), ALWAYS)
    pairs = tuple(Pair(seed, 0.0) for seed in range(len(lengths)))
    for pair in pairs:
        trials(candidate, pair.seed)
    return another_way(candidate, trials, Goal(pairs, near=9.0, enough=9.5, online=0.0, steps=designed))


@pytest.mark.parametrize(
    ("lengths", "designed", "expected"),
    [
        ((130, 130), 100.0, False),
        ((131, 131), 100.0, True),
        ((100, 100), 130.0, False),
        ((100, 100), 131.0, True),
        ((60, 160), 100.0, False),  # the mean counts
        ((None, 200), 100.0, True),
        ((None, None), 100.0, False),
        ((900,), None, False),
    ],
)
def test_alternative_is_sought_for_unusual_missions(
    lengths: tuple[int | None, ...], designed: float | None, expected: bool
) -> None:
    assert way(lengths, designed) is expected


def test_a_constant_of_nature_always_has_an_alternative() -> None:
    gravity = Candidate(Unit((constant(3, "G", 9.81),)).mutations(mutations, 2.0), ALWAYS)
    none: Any = None
    assert another_way(gravity, none, none)


def test_constants_of_the_best_statement_come_first() -> None:
    here = Unit((replace(constant(5, "E"), site=B.operands[0].site),))
    found = gentler(
        A, [A, B, C, D, here, LITERAL], entered((B, 2.2, 4.0), (C, 2.2, 3.9), (A, 2.2, 9.0)), ALWAYS, 4.0
    )
    assert found == [(B, FINE), (here, FINE), (C, COARSE), (D, COARSE)]


def test_ineffective_constants_are_left_out_after_two_factors() -> None:
    once = entered((B, 2.2, 0.0), (C, 2.2, 0.0), (C, 0.4, 0.0), (D, 2.2, 0.0), (D, 0.4, -1.0))
    assert [unit for unit, _ in gentler(A, [A, B, C, D], once, ALWAYS, 4.0)] == [B, D]
    assert [unit for unit, _ in gentler(A, [A, B, C, D], once, WET, 4.0)] == [B, C, D]


# rivals


def test_constants_of_a_function_are_alternatives_if_they_gained() -> None:
    beside = [replace(one.operands[0], site=A.operands[0].site) for one in (B, C, D)]
    b, c, d = (Unit((one,)) for one in beside)
    far = Unit((replace(beside[0], site=replace(A.operands[0].site, module="other"), code="F"),))
    gains = entered((c, 2.2, 0.0), (d, 2.2, 0.5))
    assert list(rivals(A, 2.0, [A, b, c, d, far, LITERAL], gains, ALWAYS)) == [
        *((b, 0.5), (b, 2.0), (d, 0.5), (d, 2.0)),
    ]
    assert list(rivals(A, 0.0, [A, b], gains, ALWAYS)) == []


# smaller


def test_largest_gain_is_tried_first() -> None:
    gains = entered((B, 2.2, -1.0), (C, 2.2, 3.0), (C, 0.82, 1.0), (A, 9.0, 9.0))
    found = smaller(A, 9.0, [A, B, C, D], gains, ALWAYS)
    down, up = STEPS
    assert found == [(C, up), (B, down), (B, up), (D, down), (D, up)]  # C was tried with the first step


def test_small_steps_are_limited_to_a_few_constants() -> None:
    units = [Unit((constant(line, f"U{line}"),)) for line in range(11, 20)]
    found = smaller(A, 9.0, units, Gains(0.1), ALWAYS)
    assert {unit for unit, _ in found} == {*units[:OTHERS]}


def test_booleans_get_no_smaller_change() -> None:
    flag, share = Unit((constant(6, "ON", True),)), Unit((constant(7, "S", 0.9),), SHARE)
    again = Unit(A.operands, SHARE)
    assert smaller(A, 9.0, [A, again, flag, share, LITERAL], Gains(0.1), ALWAYS) == []


def test_small_step_is_at_most_half_the_change() -> None:
    # |log 0.82| is 0.1985 and log 1.22 is 0.1989
    for half, steps in ((0.1980, []), (0.1987, [0.82]), (0.1990, [0.82, 1.22])):
        found = smaller(A, exp(2 * half), [A, B], Gains(0.1), ALWAYS)
        assert [step for _, step in found] == steps


def test_larger_steps_follow_the_three_constants_that_gained_most() -> None:
    units = [Unit((constant(line, f"U{line}"),)) for line in range(11, 16)]
    tried = [(unit, 1.22) for unit in units]
    gains = entered(
        *((unit, 1.22, gain) for unit, gain in zip(units, (1.0, 2.0, 5.0, 4.0, 3.0), strict=True))
    )
    found = onward(tried, A, 50.0, gains, ALWAYS, 10.0)
    assert len({unit for unit, _ in found}) == LEADING
    assert [unit for unit, _ in found[:LEADING]] == [units[2], units[3], units[4]]
    assert onward(tried, A, 50.0, gains, WET, 10.0) == []


@pytest.mark.parametrize(("gain", "followed"), [(0.05, True), (0.049, False)])
def test_small_gain_is_followed_by_larger_steps(gain: float, followed: bool) -> None:
    assert bool(onward([(B, 1.22)], A, 50.0, entered((B, 1.22, gain)), ALWAYS, 10.0)) is followed


def test_factor_halfway_to_one_is_the_square_root() -> None:
    assert milder(A, 2.25, {1.0: 0.0, 2.25: 9.0, 0.4: 1.0, 3.0: 1.0}) == 1.5
    assert milder(A, 0.25, {1.0: 0.0, 0.25: 9.0, 2.2: 1.0, 0.2: 1.0}) == 0.5
    assert milder(A, 2.25, {2.0: 1.0}) is None
    assert milder(A, 0.0, {}) is None


def test_the_function_inside_returns_a_factor_closer_to_one() -> None:
    assert inside(exp(1.0)) == pytest.approx(exp(0.85), abs=5e-4)
    assert inside(exp(-1.0)) == pytest.approx(exp(-0.85), abs=5e-4)
    assert inside(1.0) == 1.0
