"""What is told of candidates that were refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.accepting import Accepted, Examiner, Refused, furthest
from pytest_tarl.repairing.mutants import ORIGINAL
from pytest_tarl.searching.accept import Outcome, Reference
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import operand

SOME, ANOTHER = Candidate((), Guard()), Candidate((), Guard(()))
NONE = Refused(None, "no operand helps")


def test_any_candidate_says_more_than_none() -> None:
    refused = Refused(SOME, "gain too small")
    assert furthest(NONE, refused) is refused
    assert furthest(refused, NONE) is refused


def test_what_held_in_the_drifted_world_came_further_than_what_did_not() -> None:
    weak, costly = Refused(SOME, "gain too small", 9.0), Refused(ANOTHER, "nominal gets worse")
    assert furthest(weak, costly) is costly
    assert furthest(costly, weak) is costly


def test_among_equals_the_one_that_earned_most_is_told_and_the_first_where_none_did() -> None:
    low, high = Refused(SOME, "gain too small", 3.0), Refused(ANOTHER, "gain too small", 4.0)
    assert furthest(low, high) is high
    first, second = Refused(SOME, "gain too small"), Refused(ANOTHER, "gain too small")
    assert furthest(first, second) is first


def test_what_only_another_test_refused_came_furthest() -> None:
    costly, elsewhere = (
        Refused(SOME, "nominal gets worse", 9.0),
        Refused(ANOTHER, "another test gets worse", 8.0),
    )
    assert furthest(costly, elsewhere) is elsewhere
    assert furthest(elsewhere, costly) is elsewhere


KNOWN = range(10)  # seeds of on-line episodes; fresh ones are others
DESIGNED, DRIFTED = 10.0, 2.0
World = Callable[[int, bool], float]  # seed, whether the world drifted → reward
LOT: dict[str, World] = {
    "bad at once": lambda seed, drifted: DRIFTED,
    "lucky on known seeds": lambda seed, drifted: 6.0 if drifted and seed not in KNOWN else DESIGNED,
    "worse later than the original": lambda seed, drifted: (
        -3.0 if drifted and seed not in KNOWN else DESIGNED
    ),
    "bad as designed": lambda seed, drifted: DESIGNED if drifted else 4.0,
    "good": lambda seed, drifted: DESIGNED,
}
ENDS = {
    "bad at once": "gain too small",
    "lucky on known seeds": "gain too small",
    "worse later than the original": "worse than unrepaired",
    "bad as designed": "nominal gets worse",
    "good": "",
}


class Field:
    """Candidates in the field: what each earns is told by its place in a line-up."""

    def __init__(self, line_up: Sequence[str]) -> None:
        self.line_up = line_up
        self.candidates = [
            Candidate((Mutation(operand(at + 1, f"{at}.5", at + 0.5), 1.0),), ALWAYS)
            for at in range(len(line_up))
        ]
        noise = np.random.default_rng(3).normal(0, 0.05, 40)
        totals = DESIGNED + noise
        pairs = tuple(Pair(seed, DRIFTED) for seed in KNOWN)
        self.order: Any = SimpleNamespace(
            goal=Goal(pairs, near=9.0, enough=9.5, online=DRIFTED),
            comparison=SimpleNamespace(totals={"online": [DRIFTED] * 10}, sensors=(), sizes={}),
            fixture=SimpleNamespace(
                sample=SimpleNamespace(seeds=tuple(range(100, 140)), total=totals, episodes=40)
            ),
            reference=Reference(totals.tolist(), 1.0, 0.5, -10.0),
            options=SimpleNamespace(seed=0, alpha=0.05, edit="use"),
            drift="mud",
            permanent=False,
            neighbours=tuple,
        )

    def run(self, candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        if candidate == ORIGINAL:
            return Outcome(DESIGNED, passed=True)
        kind = self.line_up[self.candidates.index(candidate)]
        return Outcome(LOT[kind](seed, drift is not None), passed=True)

    def mutate(self, operand: object, factor: float) -> None:
        """Nothing lies between."""

    def foresee(self, wanted: object, drift: str | None) -> None:
        pass

    def source(self, candidate: Candidate) -> dict[Any, str]:
        return {}


@pytest.mark.parametrize(
    "line_up",
    [
        ("good",),
        ("bad at once", "good"),
        ("lucky on known seeds", "good"),
        ("worse later than the original", "bad as designed", "good"),
        ("bad as designed", "bad at once", "worse later than the original", "good", "lucky on known seeds"),
        ("bad as designed", "worse later than the original"),
    ],
)
def test_one_that_fails_is_dropped_the_next_is_tried_and_the_history_says_why(
    line_up: Sequence[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "pytest_tarl.searching.candidates.firing_episodes", lambda guard, sample, _: sample.seeds
    )
    field: Any = Field(line_up)
    examiner = Examiner(field, (ALWAYS,))
    trials = Trials(lambda candidate, seed: field.run(candidate, seed, "mud"), 300)
    accepted = examiner.first(iter(field.candidates), trials)
    tried = line_up[: line_up.index("good") + 1] if "good" in line_up else line_up
    assert [field.line_up[field.candidates.index(one.candidate)] for one in examiner.tried] == list(tried)
    assert [one.reason for one in examiner.tried] == [ENDS[kind] for kind in tried]
    if "good" in line_up:
        assert isinstance(accepted, Accepted)
        assert field.line_up[field.candidates.index(accepted.candidate)] == "good"
    else:
        assert accepted is None
        assert examiner.refused.candidate is not None
