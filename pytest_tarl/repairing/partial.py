"""Partial repairs: changes that gain significantly and, in the designed world, cost nothing or little of this gain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from statistics import fmean

from pytest_tarl import seeds
from pytest_tarl.errors import RepairError
from pytest_tarl.learning import bounds
from pytest_tarl.learning.drift import PASS_RATE_LOSS
from pytest_tarl.model import Reason
from pytest_tarl.repairing.accepting import Examiner
from pytest_tarl.repairing.incumbent import Watch
from pytest_tarl.repairing.mutants import ORIGINAL, Mutants
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials

MOST = 2  # maximum number of candidates that are tested
EPISODES = 40  # number of episodes per world, each paired with an episode of the unrepaired program
SCREENED = 12  # maximum number of candidates that are screened
KNOWN = 3  # number of recorded designed episodes on which a candidate is screened
PLACING = 12  # maximum number of episodes for finding the definition of a candidate's constant
LEAST = 0.1  # in the search, a candidate must have gained at least this share of the loss
# if no harmless candidate helps, candidates are tested that lose some reward in the designed world: at most this share
# of their gain
TRADED = 0.2
HARMFUL: tuple[Reason, ...] = (
    "another test gets worse",
    "cannot be written",
    "not at its definition",
    "a smaller step breaks it",
    "breaks other missions",
)


@dataclass(frozen=True)
class Gained:
    """Gain per episode over the unrepaired program, on fresh seeds; `low` is its lower confidence bound."""

    mean: float
    low: float
    failures: int  # number of additional failures, compared with the unrepaired program


@dataclass(frozen=True)
class Best:
    """A candidate that helps, with its gains in the drifted and the designed world."""

    candidate: Candidate
    drifted: Gained
    designed: Gained


def best(mutants: Mutants, examiner: Examiner, watch: Watch) -> tuple[Best | None, int]:
    """Test the best candidates; return the first with a significant gain (or None), and the number of episodes.

    Some candidates lose more than the margin in the designed world, but little compared with their gain. They are
    tested last.
    """
    tests = _Tests(mutants)
    costly: list[Candidate] = []
    for found in islice(_promising(examiner, watch), SCREENED):
        try:
            candidate, placed = _placed(mutants, examiner, found)
            tests.spent += placed + KNOWN
            lost = _lost_as_designed(mutants, candidate)
        except RepairError:
            continue
        if lost > mutants.order.reference.margin:
            if found in watch.seen and lost <= TRADED * watch.gain(found):
                costly.append(candidate)
            continue
        if (helping := tests.helping(candidate)) is not None:
            return helping, tests.spent
        if tests.number == MOST:
            break
    for candidate in costly[: MOST - tests.number]:
        if (helping := tests.helping(candidate)) is not None:
            return helping, tests.spent
    return None, tests.spent


@dataclass
class _Tests:
    """The tests of candidates on fresh seeds; `spent` counts the episodes."""

    mutants: Mutants
    number: int = 0
    spent: int = 0

    def helping(self, candidate: Candidate) -> Best | None:
        """Return the candidate with its gains; None if it does not help or loses too much in the designed world."""
        try:
            drifted = self._gained(candidate, self.mutants.order.drift)
            designed = self._gained(candidate, None) if drifted.low > 0.0 else None
        except RepairError:
            return None
        finally:
            self.number += 1
        permanent = self.mutants.order.permanent
        if designed is None or not (permanent or _affordable(self.mutants, drifted, designed)):
            return None
        return Best(candidate, drifted, designed)

    def _gained(self, candidate: Candidate, drift: str | None) -> Gained:
        self.spent += 2 * EPISODES
        return _gained(self.mutants, candidate, drift, self.number)


def _placed(mutants: Mutants, examiner: Examiner, candidate: Candidate) -> tuple[Candidate, int]:
    """Move the candidate to the definition if it works there, too. Return it and the number of episodes run."""
    trials = Trials(lambda one, seed: mutants.run(one, seed, mutants.order.drift), PLACING)
    try:
        return examiner.placing(candidate, trials) or candidate, trials.spent
    except BudgetSpentError:
        return candidate, trials.spent


def _lost_as_designed(mutants: Mutants, candidate: Candidate) -> float:
    """Return the mean loss in a few designed episodes; 0 if the drift is permanent."""
    if mutants.order.permanent:
        return 0.0
    sample = mutants.order.fixture.sample
    known = list(zip(sample.seeds, sample.total.tolist(), strict=True))[:KNOWN]
    mutants.foresee([(candidate, seed) for seed, _ in known], None)
    return fmean(total - mutants.run(candidate, seed, None).total for seed, total in known)


def _affordable(mutants: Mutants, drifted: Gained, designed: Gained) -> bool:
    """Return whether a candidate's loss in the designed world is small."""
    most = max(mutants.order.reference.margin, TRADED * drifted.low)
    return designed.low >= -most and designed.failures <= PASS_RATE_LOSS * EPISODES


def _promising(examiner: Examiner, watch: Watch) -> Iterator[Candidate]:
    """Yield the best refused candidate, then candidates with the highest gains in the search. Skip harmful ones."""
    goal = watch.order.goal
    harmful = [one.candidate.changes for one in examiner.tried if one.reason in HARMFUL]
    furthest = [examiner.refused.candidate] if examiner.refused.candidate is not None else []
    ranked = sorted(
        watch.seen, key=lambda one: -watch.gain(one) * len(watch.seen[one]) / (1 + len(watch.seen[one]))
    )
    yielded: list[Candidate] = []
    for candidate in (*furthest, *ranked):
        seen = candidate in watch.seen
        little = seen and watch.gain(candidate) < LEAST * goal.wanted
        if candidate.changes not in harmful and not little and candidate not in yielded:
            yielded.append(candidate)
            yield candidate


def _gained(mutants: Mutants, candidate: Candidate, drift: str | None, number: int) -> Gained:
    order = mutants.order
    fresh = seeds.episode_seeds(order.options.seed, f"partial {number} {drift or ''}", EPISODES)
    with_it, without = (_run(mutants, one, fresh, drift) for one in (candidate, ORIGINAL))
    gains = [one.total - other.total for one, other in zip(with_it, without, strict=True)]
    low = bounds.mean_of(gains, 1.0 - order.options.alpha / MOST).low
    failures = sum(not one.passed for one in with_it) - sum(not one.passed for one in without)
    return Gained(fmean(gains), low, failures)


def _run(mutants: Mutants, candidate: Candidate, fresh: Sequence[int], drift: str | None) -> list[Outcome]:
    mutants.foresee([(candidate, seed) for seed in fresh], drift)
    return [mutants.run(candidate, seed, drift) for seed in fresh]
