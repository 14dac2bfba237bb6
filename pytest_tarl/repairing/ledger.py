"""What became of every candidate that was examined, so that none is examined twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import copysign

from pytest_tarl.model import Reason
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.searching.search import Candidate
from tarl_lint.model import Operand

ALIKE = 0.05  # share of a value that two candidates of the same operands and guard may differ in and be one
HELD: tuple[Reason, ...] = ("nominal gets worse", "another test gets worse")  # in one world, in both of them


@dataclass(frozen=True)
class Tried:
    """A candidate that was examined, and what became of it; accepted without a reason.

    `fresh` where its totals are of seeds that nothing was chosen by, `tested` where it took a test of its own.
    """

    candidate: Candidate
    reason: Reason
    totals: tuple[float, ...]
    fresh: bool = False
    tested: bool = False


@dataclass(frozen=True)
class Refused:
    """The best that did not hold, and why; `mean` is its reward on fresh seeds, -inf where it got none."""

    candidate: Candidate | None
    reason: Reason
    mean: float = float("-inf")
    episodes: int = 0


@dataclass
class Ledger:
    """Every candidate that was examined, in order."""

    tried: list[Tried] = field(default_factory=list)

    def enter(self, tried: Tried) -> Tried:
        """Write down what became of a candidate."""
        self.tried.append(tried)
        return tried

    def alike(self, candidate: Candidate) -> Tried | None:
        """Return the entry of a candidate that is the same one, but for a few percent in its values."""
        return next((one for one in self.tried if alike(one.candidate, candidate)), None)

    def tests(self, candidate: Candidate) -> int:
        """Return how many tests on fresh seeds went to candidates of the same operands."""
        mine = operands(candidate)
        return sum(one.tested and operands(one.candidate) == mine for one in self.tried)


def operands(candidate: Candidate) -> frozenset[Operand]:
    """Return what a candidate changes."""
    return frozenset(mutation.operand for mutation in candidate.mutations)


def alike(one: Candidate, other: Candidate) -> bool:
    """Tell whether two candidates have the same operands and guard, and values within 5 %."""
    if one.guard != other.guard or operands(one) != operands(other):
        return False
    values = {mutation.operand: mutation for mutation in other.mutations}
    pairs = [(mutation, values[mutation.operand]) for mutation in one.mutations]
    return all(mine.form == its.form and _near(mine, its) for mine, its in pairs)


def _near(one: Mutation, other: Mutation) -> bool:
    first, second = float(one.value), float(other.value)
    if first == second:
        return True
    same_sign = copysign(1.0, first) == copysign(1.0, second)
    return same_sign and abs(first - second) <= ALIKE * max(abs(first), abs(second))


def of_fresh_seeds(tried: Sequence[Tried]) -> int:
    """Return how many candidates were run on fresh seeds."""
    return sum(one.fresh for one in tried)


def furthest(one: Refused, other: Refused) -> Refused:
    """Return what came further: in how many worlds it held, or else which earned more on fresh seeds."""

    def came(refused: Refused) -> tuple[bool, int, float]:
        held = HELD.index(refused.reason) + 1 if refused.reason in HELD else 0
        return refused.candidate is not None, held, refused.mean

    return other if came(other) > came(one) else one
