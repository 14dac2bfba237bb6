"""Bounds of a repaired program come from fresh episodes; those of the recording apply where nothing changes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import seeds
from pytest_tarl.repairing.accepting import Accepted
from pytest_tarl.repairing.guaranteeing import guaranteed
from pytest_tarl.searching.accept import Acceptance, Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate

CANDIDATE = Candidate((), ALWAYS)
RECORDED: Any = SimpleNamespace(success=SimpleNamespace(confidence=0.8))


class Mutants:
    """A program whose n-th episode earns n and fails if n is 1; `equal` makes all episodes alike."""

    def __init__(self, *, equal: bool = False, recorded: Any = RECORDED, **changes: Any) -> None:
        self.equal = equal
        self.ran: list[tuple[int, str | None]] = []
        self.foreseen: list[tuple[int, str | None]] = []
        self.told: list[tuple[int, int, str]] = []
        given = {
            "options": SimpleNamespace(seed=7, episodes=4, ONLINE_EPISODES=6),
            "drift": "mud",
            "permanent": False,
            "declared": None,
            "fixture": SimpleNamespace(stated=recorded),
            "progress": lambda done, total, what: self.told.append((done, total, what)),
        }
        self.order: Any = SimpleNamespace(**{**given, **changes})

    def foresee(self, wanted: Any, drift: str | None) -> None:
        assert all(candidate is CANDIDATE for candidate, _ in wanted)
        self.foreseen += [(seed, drift) for _, seed in wanted]

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        assert candidate is CANDIDATE
        number = 2 if self.equal else sum(known == drift for _, known in self.ran)
        self.ran.append((seed, drift))
        return Outcome(float(number), passed=number != 1)


def accepted(*nominal: Outcome) -> Accepted:
    return Accepted(CANDIDATE, Acceptance(True, "", (), nominal))


def test_ineffective_repair_keeps_the_recorded_bounds() -> None:
    mutants: Any = Mutants()
    found, count = guaranteed(mutants, accepted())
    assert count == 4
    assert [*found] == ["repaired", "nominal_repaired"]
    assert found["nominal_repaired"] is RECORDED
    repaired = found["repaired"]
    assert (repaired.episodes, repaired.passed, repaired.average, repaired.varied) == (4, 3, 1.5, True)
    assert repaired.success.confidence == 0.8
    fresh = [(seed, "mud") for seed in seeds.episode_seeds(7, "stated", 4)]
    assert mutants.ran == mutants.foreseen == fresh
    assert mutants.told == [(done, 4, "bounds of the repair") for done in range(4)]


def test_without_recorded_bounds_the_designed_world_has_none() -> None:
    mutants: Any = Mutants(recorded=None)
    found, _ = guaranteed(mutants, accepted())
    assert [*found] == ["repaired"]
    assert found["repaired"].success.confidence > 0.8  # the default


def test_effective_repair_runs_on_the_designed_seeds() -> None:
    mutants: Any = Mutants()
    found, count = guaranteed(mutants, accepted(Outcome(1.0, passed=True)))
    assert count == 8
    assert (found["nominal_repaired"].episodes, found["nominal_repaired"].average) == (4, 1.5)
    fresh = seeds.episode_seeds(7, "stated", 4)
    assert mutants.ran == [(seed, drift) for drift in ("mud", None) for seed in fresh]


def test_permanent_drift_has_bounds_in_the_new_world_only() -> None:
    mutants: Any = Mutants(permanent=True)
    found, count = guaranteed(mutants, accepted(Outcome(1.0, passed=True)))
    assert ([*found], count) == (["repaired"], 4)


def test_default_number_of_episodes_is_that_of_a_comparison() -> None:
    options = SimpleNamespace(seed=7, episodes=None, ONLINE_EPISODES=6)
    found, count = guaranteed(Mutants(options=options), accepted())  # type: ignore[arg-type]
    assert (found["repaired"].episodes, count) == (6, 6)


def test_bounds_of_equal_episodes_are_marked() -> None:
    found, _ = guaranteed(Mutants(equal=True), accepted())  # type: ignore[arg-type]
    assert not found["repaired"].varied


@pytest.mark.parametrize(
    ("declared", "exact"),
    [((0.0, 3.0), True), ((-1.0, 4.0), True), ((0.5, 3.0), False), ((0.0, 2.5), False), (None, False)],
)
def test_declared_range_makes_the_mean_bound_exact(declared: tuple[float, float] | None, exact: bool) -> None:
    found, _ = guaranteed(Mutants(declared=declared), accepted())  # type: ignore[arg-type]
    assert found["repaired"].mean.exact is exact
