"""Test on fresh seeds whether drifts of a chain fail too often, with few episodes for each further drift.

All drifts of a chain run on the same seeds. A seed that fails under a drift often fails under a nearer one as well, so
a test first runs the seeds that failed under the drift before it. The test counts the failures among the first 16, 32,
64 and 128 seeds of the chain, and counts seeds that have not run as passed. This can only hide failures, so a test that
stops early is wrong no more often than one that runs all seeds, whatever the drifts have in common.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import Count, Evaluator
from pytest_tarl.stressing.guarantee import hopeful, most_passed

LOOKS = (16, 32, 64, 128)  # numbers of seeds, from the first one, among which a test counts the failures
# share of the risk that each of these counts spends; the last count spends the most, because it can show the most
SPENT = (0.1, 0.15, 0.25, 0.5)
BLOCK = 8  # number of episodes after which a test checks for a decision


@dataclass
class RateTests:
    """The tests of a chain whose drifts fail too often; each test has the error probability `risk`."""

    evaluator: Evaluator
    pool: str
    risk: float
    ran: set[int] = field(default_factory=set)  # seeds that ran under the last confirmed drift
    failed: set[int] = field(default_factory=set)  # the seeds in `ran` whose episodes failed

    def confirm(self, point: Point) -> bool:
        """Return whether fresh episodes show that too few episodes pass at a point. Raise BudgetSpentError."""
        looks, groups = self._looks(), self._groups()
        outcomes: dict[int, bool] = {}  # number of a seed → whether its episode failed
        shown = False
        try:
            for block in _blocks(groups):
                found = self.evaluator.ordered(self.pool, point, block)
                outcomes.update((row, not found[row].passed) for row in block)
                shown = any(
                    sum(failed for row, failed in outcomes.items() if row < size) >= least
                    for size, least in looks
                )
                if shown or _forecast(groups, outcomes) < looks[-1][1]:
                    break
        finally:
            if outcomes:
                self.evaluator.count(self.pool, Count(point, *self._estimate(outcomes)))
        if shown:
            self.ran = {*self.ran, *outcomes}
            self.failed = {row for row, failed in outcomes.items() if failed}
        return shown

    def _looks(self) -> list[tuple[int, int]]:
        """Return pairs: a number of seeds, and the minimum number of failures among them that shows the failure."""
        given = self.evaluator.guarantee
        return [
            (size, size - most_passed(given, size, self.risk * share, "rate"))
            for size, share in zip(LOOKS, SPENT, strict=True)
        ]

    def _estimate(self, outcomes: Mapping[int, bool]) -> tuple[float, int]:
        """Return an estimate of the number of failures, and the number of seeds that it is about.

        The seeds are those that ran under this drift or under the one before. Of those that failed under the one
        before, and of those that passed, only some may have run; the latter pass if none has.
        """
        new = [failed for row, failed in outcomes.items() if row not in self.ran]
        failures, seeds = float(sum(new)), len(new)
        for group in (self.failed, self.ran - self.failed):
            found = [outcomes[row] for row in group if row in outcomes]
            failures += len(group) * sum(found) / len(found) if found else 0.0
            seeds += len(group)
        return failures, seeds

    def _groups(self) -> list[list[int]]:
        """Return the seeds in the order of their runs: those that failed before, then new ones, then the rest."""
        every = range(LOOKS[-1])
        parts = (
            [row for row in every if row in self.failed],
            [row for row in every if row not in self.ran],
            [row for row in every if row in self.ran and row not in self.failed],
        )
        return [part for part in parts if part]


def _blocks(groups: Sequence[Sequence[int]]) -> Iterator[list[int]]:
    for group in groups:
        left = iter(group)
        while block := list(islice(left, BLOCK)):
            yield block


def _forecast(groups: Sequence[Sequence[int]], outcomes: Mapping[int, bool]) -> float:
    """Return the number of failures among all seeds if those that have not run fail a little more often than the last.

    The first group of several failed under another drift, so its failures say little about the others, which then all
    count.
    """
    known = 0.0
    for number, group in enumerate(groups):
        found = [outcomes[row] for row in group if row in outcomes]
        known += sum(found)
        left = len(group) - len(found)
        if left:
            later = sum(len(other) for other in groups[number + 1 :])
            if not found:
                return known + left + later
            share = hopeful(sum(found), len(found))
            return known + share * left + (share * later if number or not later else later)
    return known
