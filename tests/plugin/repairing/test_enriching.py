"""Rare failures: missions that fail for a detectable reason that is rare in the drifted world."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.repairing.enriching import CONTROLS, ENOUGH, LOOKED_AT, SHARE, enriched
from pytest_tarl.repairing.mutants import ORIGINAL
from pytest_tarl.searching.accept import Outcome, Reference
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials

DESIGNED, HARD, LOST = 10.0, 9.0, -20.0  # a hard mission earns less even in the designed world


class Road:
    """Some missions are hard and lost under the drift. The second sensor detects the cause."""

    def __init__(self, share: float, online: int = 40, seed: int = 0) -> None:
        self.share, self.seed = share, seed
        self.ran: list[tuple[int, str | None]] = []
        recorded, met = range(1000, 1150), range(online)
        totals = [self.total(one, None) for one in recorded]
        lost = [Pair(one, LOST) for one in met if self.hard(one)]
        goal = Goal(
            tuple(lost) or tuple(Pair(one, DESIGNED) for one in met),
            near=DESIGNED - 0.5,
            enough=DESIGNED - 0.5,
            online=sum(self.total(one, "wet") for one in met) / online,
            passing=True,
        )
        self.order: Any = SimpleNamespace(
            goal=goal,
            drift="wet",
            online=SimpleNamespace(recorded=SimpleNamespace(sample=self.sample(met, "wet"))),
            fixture=SimpleNamespace(sample=self.sample(recorded, None)),
            reference=Reference(totals, 1.0, 0.5, LOST),
        )

    def hard(self, seed: int) -> bool:
        return bool(np.random.default_rng([self.seed, seed]).random() < self.share)

    def total(self, seed: int, drift: str | None) -> float:
        return DESIGNED if not self.hard(seed) else HARD if drift is None else LOST

    def sample(self, seeds: range, drift: str | None) -> Any:
        wet = int(drift is not None)
        cells = [(wet, 0), (wet, 1)]
        way = [(at, cell) for at, one in enumerate(seeds) for cell in ([0, 1] if self.hard(one) else [0])]
        return SimpleNamespace(
            seeds=tuple(seeds),
            episodes=len(seeds),
            total=np.array([self.total(one, drift) for one in seeds]),
            steps=np.full(len(seeds), 100),
            cells=cells,
            chain=SimpleNamespace(
                episode=np.array([at for at, _ in way]), cell=np.array([cell for _, cell in way])
            ),
        )

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        assert candidate == ORIGINAL
        self.ran.append((seed, drift))
        return Outcome(self.total(seed, drift), passed=self.total(seed, drift) > 0)


def never(candidate: Candidate, seed: int) -> Outcome:
    raise AssertionError("nothing is searched here")


@pytest.mark.parametrize("share", [0.08, 0.12, 0.3])
def test_recorded_missions_in_failed_bins_are_found(share: float) -> None:
    road: Any = Road(share)
    trials = Trials(never, 300)
    goal = enriched(road, trials)
    assert len(goal.pairs) == ENOUGH
    assert all(road.hard(pair.seed) for pair in goal.pairs)
    assert (
        trials.spent == len(road.ran) <= ENOUGH
    )  # each run either finds a hard mission or measures its designed reward
    assert len(goal.controls) == CONTROLS
    assert not any(road.hard(pair.seed) for pair in goal.controls)


def test_failing_mission_is_compared_with_its_designed_reward() -> None:
    road: Any = Road(0.12)
    goal = enriched(road, Trials(never, 300))
    seed, easy = goal.pairs[0].seed, goal.controls[0].seed
    assert not road.order.goal.reached(Outcome(HARD, passed=True), seed)
    assert goal.reached(Outcome(HARD, passed=True), seed)
    assert not goal.reached(Outcome(HARD - 0.6 - goal.tolerated[seed], passed=True), seed)
    assert not goal.reached(Outcome(HARD, passed=True), easy)
    assert goal.enough_on([seed]) < goal.enough_on([easy]) == goal.enough


@pytest.mark.parametrize("share", [0.05, 0.12, 0.3])
def test_repair_may_earn_less_on_a_few_missions(share: float) -> None:
    road: Any = Road(share)
    goal, margin = enriched(road, Trials(never, 300)), road.order.reference.margin
    losing = len(road.order.goal.pairs) / 40
    for pair in goal.pairs:
        less = margin + goal.tolerated[pair.seed]
        assert margin < less
        assert losing * less == pytest.approx(SHARE * margin)
        least = goal.near - goal.harder[pair.seed] - goal.tolerated[pair.seed]
        assert goal.reached(Outcome(least + 0.01, passed=True), pair.seed)
        assert not goal.reached(Outcome(least - 0.01, passed=True), pair.seed)
        assert not goal.reached(Outcome(least + 0.01, passed=False), pair.seed)
    for control in goal.controls:
        assert not goal.reached(Outcome(DESIGNED - 1.1 * margin, passed=True), control.seed)


def test_repair_must_restore_half_of_a_loss() -> None:
    road: Any = Road(0.05)
    road.order.goal = replace(
        road.order.goal, pairs=tuple(replace(one, total=HARD - 2.0) for one in road.order.goal.pairs)
    )
    goal = enriched(road, Trials(never, 300))
    seed = road.order.goal.pairs[0].seed
    assert goal.reached(Outcome(HARD - 0.99, passed=True), seed)
    assert not goal.reached(Outcome(HARD - 1.01, passed=True), seed)


def test_no_extra_episodes_if_most_missions_lose() -> None:
    for share in (0.0, 0.9):
        road: Any = Road(share)
        assert enriched(road, Trials(never, 300)) == road.order.goal
        assert road.ran == []


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 30), st.floats(0.03, 0.45), st.integers(0, 100))
def test_the_search_for_failing_missions_stays_within_any_budget(
    budget: int, share: float, seed: int
) -> None:
    road: Any = Road(share, seed=seed)
    trials = Trials(never, budget)
    goal = enriched(road, trials)
    assert trials.spent == len(road.ran) <= min(budget, ENOUGH + LOOKED_AT)
    assert replace(goal, harder={}, tolerated={}, controls=(), pairs=()) == replace(road.order.goal, pairs=())


@pytest.mark.parametrize(("less", "found"), [(0.01, True), (0.0, False)])
def test_mission_fails_if_its_loss_exceeds_the_slack(less: float, found: bool) -> None:
    """The first recorded mission that visits the bins of failed ones loses reward; the others lose nothing."""
    road: Any = Road(0.12)
    slack, first = road.order.reference.mean - road.order.goal.near, list[int]()
    total = HARD - slack - less

    def run(_: Candidate, seed: int, drift: str | None) -> Outcome:
        if drift is not None and not first:
            first.append(seed)
        lost = drift is not None and seed in first
        return Outcome(total if lost else road.total(seed, None), passed=True)

    road.run = run
    goal = enriched(road, Trials(never, 300))
    assert (Pair(first[0], total) in goal.pairs) is found
    assert len(goal.pairs) == len(road.order.goal.pairs[:ENOUGH]) + found
