"""The results of all examined candidates, so that none is examined twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import copysign

from pytest_tarl.model import Reason
from pytest_tarl.patching.mutate import Mutation, step_of
from pytest_tarl.searching.search import Candidate
from tarl_lint.model import Operand

# under the same guard, values of the same operands count as equal up to this relative difference
ALIKE = 0.05
# reasons for refusing a candidate after it passed in the drifted world (first reason) or in both worlds (second reason)
HELD: tuple[Reason, ...] = ("nominal gets worse", "another test gets worse")


@dataclass(frozen=True)
class Tried:
    """An examined candidate and its result; `reason` is "" if it was accepted.

    `fresh` is true if the candidate's totals are from fresh seeds, `tested` if the candidate had a test of its own.
    """

    candidate: Candidate
    reason: Reason
    totals: tuple[float, ...]
    fresh: bool = False
    tested: bool = False


@dataclass(frozen=True)
class Refused:
    """A refused candidate, the reason, and its mean reward on fresh seeds (-inf if it never ran there)."""

    candidate: Candidate | None
    reason: Reason
    mean: float = float("-inf")
    episodes: int = 0


@dataclass
class Ledger:
    """Every examined candidate, in order."""

    tried: list[Tried] = field(default_factory=list)

    def enter(self, tried: Tried) -> Tried:
        """Store and return the result of a candidate."""
        self.tried.append(tried)
        return tried

    def alike(self, candidate: Candidate) -> Tried | None:
        """Return the entry of an equal or nearly equal candidate, or None if there is none."""
        return next((one for one in self.tried if alike(one.candidate, candidate)), None)

    def knows(self, candidate: Candidate) -> bool:
        """Return whether an equal or nearly equal candidate was examined."""
        return self.alike(candidate) is not None

    def examined(self, candidate: Candidate) -> bool:
        """Return whether a candidate's exact values were examined under its guard, at any place in the source."""
        return any(
            one.candidate.guard == candidate.guard and one.candidate.changes == candidate.changes
            for one in self.tried
        )

    def tests(self, candidate: Candidate) -> int:
        """Return the number of tests spent on candidates of the same operands."""
        mine = operands(candidate)
        return sum(one.tested and operands(one.candidate) == mine for one in self.tried)


def operands(candidate: Candidate) -> frozenset[Operand]:
    """Return the operands that a candidate changes."""
    return frozenset(mutation.operand for mutation in candidate.mutations)


def alike(one: Candidate, other: Candidate) -> bool:
    """Return whether two candidates have equal operands and guards and nearly equal values (or steps on a chart)."""
    if one.guard != other.guard or operands(one) != operands(other):
        return False
    values = {mutation.operand: mutation for mutation in other.mutations}
    pairs = [(mutation, values[mutation.operand]) for mutation in one.mutations]
    return all(mine.form == its.form and _near(mine, its) for mine, its in pairs)


def _near(one: Mutation, other: Mutation) -> bool:
    first, second = float(one.value), float(other.value)
    if first == second:
        return True
    steps = step_of(one), step_of(other)
    if steps[0] is not None and steps[1] is not None:
        first, second = steps[0], steps[1]
    same_sign = copysign(1.0, first) == copysign(1.0, second)
    return same_sign and abs(first - second) <= ALIKE * max(abs(first), abs(second))


def of_fresh_seeds(tried: Sequence[Tried]) -> int:
    """Return how many candidates ran on fresh seeds."""
    return sum(one.fresh for one in tried)


def furthest(one: Refused, other: Refused) -> Refused:
    """Return the candidate that passed in more worlds or, on ties, earned more on fresh seeds."""

    def came(refused: Refused) -> tuple[bool, int, float]:
        held = HELD.index(refused.reason) + 1 if refused.reason in HELD else 0
        return refused.candidate is not None, held, refused.mean

    return other if came(other) > came(one) else one
