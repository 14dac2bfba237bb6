"""Values that pass easy missions but lose the missions of rejected changes are moved on, towards the better side."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.lost_missions import MOVES, better_factor
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import units
from tests.plugin.searching.test_gains import constant

GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.0, enough=9.5, online=0.0)
HARD = 77  # seed of a mission that a rejected change lost


class World:
    """All values of a range pass the easy missions; only those of a narrower range pass the hard one."""

    def __init__(self, easy: tuple[float, float], hard: tuple[float, float]) -> None:
        self.ranges = dict.fromkeys(range(4), easy) | {HARD: hard}
        self.ran: list[tuple[float, int]] = []
        self.trials = Trials(
            self.run,
            100,
            loses=lambda candidate: self.trials(candidate, HARD).total < GOAL.near,
            lost_missions=lambda: [HARD],
        )

    def run(self, candidate: Candidate, seed: int) -> Outcome:
        factor = float(candidate.mutations[0].value)
        self.ran.append((round(factor, 2), seed))
        low, high = self.ranges[seed]
        return Outcome(10.0 - 5.0 * max(low - factor, factor - high, 0.0), True)

    def attempts(self) -> Attempts:
        return Attempts(units([constant(3, "PLAY")]), mutations, (ALWAYS,), self.trials, GOAL)


@pytest.mark.parametrize(
    ("easy", "hard", "first", "tried", "found"),
    [
        ((1.4, 3.0), (1.7, 2.5), 1.5, 2.2, 1.82),  # between the first value and a farther one that was tried
        ((1.4, 3.0), (1.7, 2.5), 1.5, 1.0, 2.27),  # halfway to 2.3 times the first value
        ((1.4, 3.0), (1.45, 1.6), 2.2, 1.0, 1.48),  # back towards the old value
        ((0.3, 0.7), (0.3, 0.5), 0.6, 0.4, 0.49),  # below 1, outwards is downwards
    ],
)
def test_value_moves_to_the_side_where_the_lost_mission_gains(easy, hard, first, tried, found) -> None:
    world = World(easy, hard)
    (unit,) = world.attempts().units
    changed = unit.mutations(mutations, first)
    better = better_factor(unit, Candidate(changed, ALWAYS), first, [tried, first], mutations, world.trials)
    assert better == pytest.approx(found, abs=0.01)
    assert {seed for _, seed in world.ran} == {HARD}


def test_value_stays_if_no_neighbour_earns_more() -> None:
    world = World((1.4, 3.0), (1.5, 1.5))
    (unit,) = world.attempts().units
    for first, trials in ((1.5, world.trials), (1.4, Trials(world.run, 100))):
        candidate = Candidate(unit.mutations(mutations, first), ALWAYS)
        assert better_factor(unit, candidate, first, [2.2], mutations, trials) is None


def test_a_constant_is_moved_on_and_confirmed() -> None:
    world = World((1.4, 3.0), (2.2, 2.4))
    tries = world.attempts()
    found = [one.mutations[0].value for one in tries.attempt(tries.units[0], ALWAYS, 1.5, 0)]
    assert found[:1] == [pytest.approx(2.27, abs=0.01)]
    assert [factor for factor, seed in world.ran if seed == HARD][:2] == [1.5, 2.27]


def test_constant_moves_while_the_lost_mission_gains() -> None:
    world = World((1.4, 90.0), (50.0, 60.0))
    tries = world.attempts()
    assert not list(tries.attempt(tries.units[0], ALWAYS, 1.5, 0))
    moved = [factor for factor, seed in world.ran if seed == HARD]
    assert moved == [1.5, 2.27, 3.45, 5.23]
    assert len(moved) == 1 + MOVES


@pytest.mark.parametrize(
    ("first", "hard", "tried", "ran", "found"),
    [
        (0.4, (0.05, 0.2), [2.2], [0.26, 0.17], 0.17),  # downwards: 0.4 and 0.26 act like 0.5
        (0.3, (0.05, 0.2), [0.05], [0.12], 0.12),
        (0.49, (0.05, 0.2), [0.05, 0.42], [0.45, 0.14], 0.14),  # 0.42 is close to 0.45
        (0.49, (0.05, 0.1), [0.33, 0.42], [0.45, 0.37, 0.74], None),
        (0.3, (0.7, 1.2), [0.24, 0.8], [0.27, 0.25, 0.49, 0.63], 0.63),  # back over the plateau
        (1.1, (2.6, 9.0), [1.0], [1.67, 2.53], 2.53),
    ],
)
def test_a_value_on_a_plateau_leaves_it(first, hard, tried, ran, found) -> None:
    world = World((0.01, 99.0), hard)
    inner = world.run

    def coarse(candidate: Candidate, seed: int) -> Outcome:
        """Run a node that acts only at multiples of 0.25, 0.5, 1.5 …"""
        factor = float(candidate.mutations[0].value)
        outcome = inner(candidate, seed)
        low, high = world.ranges[seed]
        level = next(level for level in (0.2, 0.5, 1.0, 2.0, 4.0, 8.0, 99.0) if factor <= level)
        return Outcome(10.0 - 5.0 * max(low - level, level - high, 0.0), outcome.passed)

    trials = Trials(coarse, 100, lost_missions=lambda: [HARD])
    (unit,) = world.attempts().units
    candidate = Candidate(unit.mutations(mutations, first), ALWAYS)
    better = better_factor(unit, candidate, first, [*tried, first], mutations, trials)
    assert better == (None if found is None else pytest.approx(found, abs=0.01))
    assert [factor for factor, _ in world.ran] == pytest.approx([first, *ran], abs=0.01)
