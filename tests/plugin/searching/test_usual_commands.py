"""Before a change with unusually large commands, the same step is tried on other constants."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import USUAL, Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from tests.plugin.searching.test_search import operand

GOAL = Goal(tuple(Pair(seed, 0.0, 40) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True)
POWER, PAUSE, DELAY = operand(3, "0.75", 0.75), operand(4, "1.4", 1.4), operand(5, "2.0", 2.0)


def outputs(power: float) -> tuple[tuple[str, tuple[float, ...]], ...]:
    return (("heater", (30.0, 400.0, power)),)


def kettle(candidate: Candidate, seed: int) -> Outcome:
    """A mission succeeds with far too much power, or with a long pause."""
    by = {one.operand: float(one.value) for one in candidate.mutations}
    power, pause = by.get(POWER, 0.75), by.get(PAUSE, 1.4)
    good = power > 3.0 or 5.0 < pause < 9.0
    return Outcome(
        10.0 if good else 0.0, good, steps=30 + round(5 * pause + 4 * power), outputs=outputs(power)
    )


@pytest.mark.parametrize(
    ("designed", "first"),
    [
        (outputs(0.75), PAUSE),
        (outputs(4.0), POWER),  # such commands are usual
        (outputs(0.0), POWER),  # nothing is known about the size of commands
        ((), POWER),
    ],
)
def test_a_change_without_unusual_commands_comes_first(
    designed: tuple[tuple[str, tuple[float, ...]], ...], first: object
) -> None:
    trials = Trials(kettle, 300, design=lambda _: Outcome(10.0, True, steps=40, outputs=designed))
    found = Sweep((POWER, DELAY, PAUSE), mutations, (ALWAYS,), trials, GOAL).candidates()
    assert [one.operand for one in next(found).mutations] == [first]
    if first == PAUSE:
        assert any(one.operand == POWER for candidate in found for one in candidate.mutations)


@pytest.mark.parametrize(("ratio", "expected"), [(USUAL * 1.01, True), (USUAL * 0.99, False)])
def test_commands_are_compared_by_topic(ratio: float, expected: bool) -> None:
    made = outputs(ratio)[0], ("lamp", (9.0, 9.0, 9.0))
    trials = Trials(
        lambda _, __: Outcome(10.0, True, outputs=made),
        10,
        design=lambda _: Outcome(10.0, True, outputs=outputs(1.0)),
    )
    assert trials.exceeds(Candidate((), ALWAYS), 0) is expected
    assert trials.beside == 1
