"""Constants that must move together by different factors are found by a joint search."""

from __future__ import annotations

from math import log

import numpy as np
import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.jointly import Surrogate, expected_improvement, sensitive
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit, units, whole_constants
from tarl_lint.model import Operand, SiteId, Span


def operand(line: int, code: str, value: float = 2.0, path: str = "node.py") -> Operand:
    span, elsewhere = Span(path, line, 5, line, 9), Span(path, 1, 1, 1, 4)
    return Operand(SiteId("node", "run", f"line {line}"), span, code, value, elsewhere)


STIFF, DAMPED = operand(3, "STIFF"), operand(4, "DAMPED")
OTHERS = tuple(operand(line, f"OTHER_{line}") for line in range(5, 10))
WANTED = 12.0  # gain of both constants at their best values


def swing(candidate: Candidate, seed: int) -> Outcome:
    """A ridge: the constants must be multiplied by 3 and by 6.5; one alone restores at most a part of the reward."""
    moved = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
    if min(moved.values(), default=1.0) < 0:
        return Outcome(-9.0, False)
    stiff, damped = log(moved.get(STIFF, 1.0) / 3.0), log(moved.get(DAMPED, 1.0) / 6.5)
    others = sum(abs(log(moved.get(one, 1.0))) for one in OTHERS)
    lost = 0.95 * (stiff + damped) ** 2 + 6.0 * (damped - stiff) ** 2 + 2.0 * others
    total = max(WANTED - lost, -9.0)
    return Outcome(total, total >= 0.9 * WANTED)


def search() -> tuple[dict[Operand, float], int]:
    pairs = tuple(Pair(seed, swing(Candidate((), ALWAYS), seed).total) for seed in range(8))
    goal = Goal(pairs, near=0.9 * WANTED, enough=0.9 * WANTED, online=0.0, passing=True)
    trials = Trials(swing, 260)
    sweep = Sweep([*OTHERS, STIFF, DAMPED], mutations, (ALWAYS,), trials, goal, np.random.default_rng(1))
    found = next(sweep.candidates())
    return {mutation.operand: float(mutation.value) for mutation in found.mutations}, trials.spent


def test_two_constants_that_must_grow_together_are_found() -> None:
    found, spent = search()
    assert found.keys() == {STIFF, DAMPED}
    assert 2.0 < found[STIFF] < 4.5
    assert 4.0 < found[DAMPED] < 10.0
    assert spent < 200
    assert search() == (found, spent)


def test_surrogate_ignores_ineffective_constants() -> None:
    draws = np.random.default_rng(0)
    points = draws.uniform(-1.0, 1.0, (40, 2))
    fitted = Surrogate(points, np.sin(3.0 * points[:, 0]))
    mean, deviation = fitted.predict(np.array([[0.5, -0.9], [0.5, 0.9], [9.0, 0.0]]))
    assert mean[:2] == pytest.approx([np.sin(1.5)] * 2, abs=0.1)
    assert deviation[2] > 5 * deviation[0]
    assert fitted.fitted[1] > fitted.fitted[0]


def test_improvement_is_expected_at_high_means_or_uncertainty() -> None:
    mean, deviation = np.array([0.0, 1.0, 0.0]), np.array([0.1, 0.1, 2.0])
    low, high, unknown = expected_improvement(mean, deviation, 0.9).tolist()
    assert low < 1e-6 < high
    assert low < unknown
    assert high == pytest.approx(0.1083, abs=1e-3)


def test_uses_of_a_named_constant_move_together() -> None:
    first, again = operand(3, "WHEEL"), operand(8, "WHEEL")
    there, literal = operand(3, "WHEEL", path="other.py"), operand(9, "2.0")
    found = whole_constants(units([first, literal, again, there]))
    assert [unit.operands for unit in found] == [(first, again), (literal,), (there,)]


def test_named_constants_that_change_missions_most_come_first() -> None:
    gains = Gains(0.1)
    weak, strong = Unit((OTHERS[0],)), Unit((STIFF,))
    zero, flag = Unit((operand(20, "ZERO", 0.0),)), Unit((operand(21, "FLAG", True),))
    for unit, gain in ((weak, 0.1), (strong, -3.0), (zero, 5.0), (flag, 5.0)):
        gains.enter((unit, ALWAYS), 2.2, gain)
    assert sensitive([weak, zero, flag, strong], gains, ALWAYS) == ([strong, weak], 1)
