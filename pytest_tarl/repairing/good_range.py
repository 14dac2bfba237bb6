"""Move a value from the end of the range of good values towards its middle, before the expensive test.

A value at the end of the range passes the known missions and fails on some fresh seeds. The search tends to find such
values: it tries large steps first and then prefers the value nearest to the old one. Most of the range is known from
the values that ran before; a few more missions with the hardest known seed show where it ends.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import copysign, exp, inf, log
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import to_step
from pytest_tarl.repairing.between import common_factor
from pytest_tarl.repairing.ledger import operands
from pytest_tarl.searching.accept import Outcome, Reference
from pytest_tarl.searching.search import LACKS, Candidate, Goal, Mutate, Trials
from tarl_lint.model import Operand

# a value is moved if it lies in the outer part of the range (this share at each end) and its ratio to the end is less
# than `CLEAR`
OUTER = 0.25
CLEAR = 1.4  # a value is far enough from an end of the range if their ratio is at least this
# a value is moved to this share of the range, counted from the end that is nearer to the old value
MIDDLE = 0.45
# maximum ratio of the new value to the end nearer to the old value; larger changes are less likely to suit other
# missions
FAR = 2.0
ROUNDING = 0.1  # share of the range by which the new value may be rounded
PROBES = 3  # maximum number of missions that show where the range ends
SEEDS = 5  # number of known seeds on which the new value must pass
COSTS = 0.1  # maximum reward that the new value may lose, as a share of the margin
# minimum ratio between the farthest good value and the first value that is tried beyond it
FARTHER = 1.3
OPEN = 1.32  # minimum ratio between the ends of a range if one end is unknown
NARROW = 1.1  # a value is moved only if the ratio between the ends of the range is at least this


@dataclass
class GoodRange:
    """Find the ranges of good values of one search, each constant once."""

    mutate: Mutate
    _seen: set[frozenset[Operand]] = field(default_factory=set)

    def amid(self, candidate: Candidate, trials: Trials, goal: Goal, reference: Reference) -> Candidate:
        """Return the candidate, if possible with a value in the middle of the good range. Raise BudgetSpentError."""
        by = common_factor(candidate)
        if by is None or by == 1.0 or operands(candidate) in self._seen:
            return candidate
        self._seen.add(operands(candidate))
        ends = _Ends(candidate, by, trials, goal, self.mutate)
        ends.probe()
        inside = (one for one in ends.inside() if _as_good(one, candidate, trials, goal, reference))
        return next(inside, candidate)


class _Ends:
    """The ends of the range around a candidate's value, as |log(factor)|; `by` is the candidate's factor.

    `inner` and `outer` are the nearest values on both sides that are known to be bad; the old value counts as bad.
    `nearest` and `farthest` are the outermost values between these two that are known to be good.
    """

    def __init__(self, candidate: Candidate, by: float, trials: Trials, goal: Goal, mutate: Mutate) -> None:
        self.candidate = candidate
        self.trials = trials
        self.goal = goal
        self.mutate = mutate
        self.place, self.sign = abs(log(by)), copysign(1.0, log(by))
        self.inner, self.outer = 0.0, inf
        values = list(self._known())
        for at, good in values:
            if not good:
                self._bad(at)
        between = [at for at, good in values if good and self.inner < at < self.outer]
        self.nearest, self.farthest = min(between, default=self.place), max(between, default=self.place)

    def _known(self) -> Iterator[tuple[float, bool]]:
        """Yield the values of the same constants that ran, and whether all of their missions earned enough."""
        for other, outcomes in self.trials.alike(self.candidate).items():
            by = common_factor(other)
            if by is None or log(by) * self.sign <= 0.0:
                continue
            good = not any(_short(one, seed, self.goal) for seed, one in outcomes.items())
            yield abs(log(by)), good or other.changes == self.candidate.changes

    def _bad(self, at: float) -> None:
        if at < self.place:
            self.inner = max(self.inner, at)
        elif at > self.place:
            self.outer = min(self.outer, at)

    @property
    def within(self) -> bool:
        """Return whether the value lies far enough from both ends."""
        margin = min(OUTER * (self.outer - self.inner), log(CLEAR))
        return self.inner + margin <= self.place <= self.outer - margin

    def probe(self) -> None:
        """Run values beyond the good ones until it is clear whether the candidate's value is at an end of the range."""
        if self.outer == inf:
            beyond = self.farthest + max((self.farthest - self.inner) / 2, log(FARTHER))
            if self._try(beyond):
                # this end is not known: assume an end for which the value lies in the middle of the range
                self.outer = max(2.0 * self.place - self.inner, self.inner + log(OPEN))
                self.farthest = min(self.farthest, self.outer)
        for _ in range(PROBES - 1):
            if self.within or self.outer == inf:
                return
            near = self.place - self.inner < self.outer - self.place
            low, high = (self.farthest, self.outer) if near else (self.inner, self.nearest)
            if high - low <= OUTER * (self.outer - self.inner):
                return
            self._try((low + high) / 2)

    def _try(self, at: float) -> bool:
        """Run a value on the seed that most candidates failed, and store whether it is good."""
        candidate, pairs = self._at(at), self.goal.pairs
        worst = max(pairs, key=lambda pair: self.trials.misses[pair.seed])
        try:
            good = candidate is not None and not _short(
                self.trials(candidate, worst.seed), worst.seed, self.goal
            )
        except RepairError:
            good = False
        if good:
            self.nearest, self.farthest = min(self.nearest, at), max(self.farthest, at)
        else:
            self._bad(at)
        return good

    def inside(self) -> Iterator[Candidate]:
        """If the value lies at an end of the range, yield the value in the middle, then the value halfway there."""
        width = self.outer - self.inner
        if self.within or width == inf or width < log(NARROW):
            return
        middle = self.inner + min(MIDDLE * width, log(FAR))
        for at in (middle, (middle + self.place) / 2):
            found = self._at(at, ROUNDING * width)
            if found is not None and found.changes != self.candidate.changes:
                yield found

    def _at(self, at: float, rounding: float = 0.0) -> Candidate | None:
        """Return the candidate with another value, which may be rounded by a ratio of exp(`rounding`)."""
        made = []
        for mutation in self.candidate.changes:
            by, value = exp(self.sign * at), mutation.operand.value
            if value and mutation.chart is None:
                by = rounded(value * by, rounding) / value
            made.append(to_step(mutation, by, self.mutate))
        changed = tuple(one for one in made if one is not None)
        return replace(self.candidate, mutations=changed) if len(changed) == len(made) else None


def rounded(value: float, tolerance: float) -> float:
    """Round to as few digits as possible, by a ratio of at most exp(`tolerance`)."""
    for digits in range(1, 4):
        short = float(f"{value:.{digits}g}")
        if abs(log(short / value)) <= tolerance:
            return short
    return value


def _short(outcome: Outcome, seed: int, goal: Goal) -> bool:
    """Return whether a mission failed or clearly earned too little."""
    clearly = replace(goal, near=goal.near - LACKS * max(goal.near - goal.online, 0.0))
    return not clearly.reached(outcome, seed)


def _as_good(
    target: Candidate, candidate: Candidate, trials: Trials, goal: Goal, reference: Reference
) -> bool:
    """Return whether a value passes on known seeds and earns about as much there. Raise BudgetSpentError."""
    pairs = sorted(goal.pairs, key=lambda pair: not trials.ran(candidate, [pair]))[:SEEDS]
    try:
        if not all(trials.reaches(target, pair.seed, goal) for pair in pairs) or trials.loses(target):
            return False
    except RepairError:
        return False
    mine, its = (fmean(trials(one, pair.seed).total for pair in pairs) for one in (target, candidate))
    return mine >= its - COSTS * reference.margin
