"""Partial repairs: candidates whose gain is significant but too small, and that do no harm in the designed world."""

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
KNOWN = 3  # number of recorded episodes of the designed world in which a candidate is screened
PLACING = 12  # maximum number of episodes that look for the definition of a candidate's constant
LEAST = 0.1  # share of the loss that a candidate must have gained in the search
HARMFUL: tuple[Reason, ...] = (
    "nominal gets worse",
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
    """Test the best candidates; return the first with a significant gain (or None), and the number of episodes."""
    spent, number = 0, -1
    for found in islice(_promising(examiner, watch), SCREENED):
        try:
            candidate, placed = _placed(mutants, examiner, found)
            spent += placed + KNOWN
            if not _mild(mutants, candidate):
                continue
            number += 1
            if number == MOST:
                break
            drifted = _gained(mutants, candidate, mutants.order.drift, number)
            spent += 2 * EPISODES
            if drifted.low <= 0.0:
                continue
            designed = _gained(mutants, candidate, None, number)
            spent += 2 * EPISODES
        except RepairError:
            continue
        if mutants.order.permanent or _harmless(mutants, designed):
            return Best(candidate, drifted, designed), spent
    return None, spent


def _placed(mutants: Mutants, examiner: Examiner, candidate: Candidate) -> tuple[Candidate, int]:
    """Return the candidate, moved to the definition if that has the same effect, and the number of episodes."""
    trials = Trials(lambda one, seed: mutants.run(one, seed, mutants.order.drift), PLACING)
    try:
        return examiner.placing(candidate, trials) or candidate, trials.spent
    except BudgetSpentError:
        return candidate, trials.spent


def _mild(mutants: Mutants, candidate: Candidate) -> bool:
    """Return whether a candidate loses at most the margin in a few recorded episodes of the designed world."""
    if mutants.order.permanent:
        return True
    sample, margin = mutants.order.fixture.sample, mutants.order.reference.margin
    known = list(zip(sample.seeds, sample.total.tolist(), strict=True))[:KNOWN]
    mutants.foresee([(candidate, seed) for seed, _ in known], None)
    lost = [total - mutants.run(candidate, seed, None).total for seed, total in known]
    return fmean(lost) <= margin


def _harmless(mutants: Mutants, designed: Gained) -> bool:
    margin = mutants.order.reference.margin
    return designed.low >= -margin and designed.failures <= PASS_RATE_LOSS * EPISODES


def _promising(examiner: Examiner, watch: Watch) -> Iterator[Candidate]:
    """Yield the best refused candidate, then those with the highest gains in the search; skip harmful ones."""
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
