"""Test on fresh seeds whether the drifts of a chain fail too often, with few episodes per additional drift.

All drifts of a chain run on the same seeds. A seed that fails under one drift often fails under a nearer one as well,
so each test starts with the seeds that failed under the previous drift. It counts the failures among the first 16, 32,
64 and 128 seeds of the chain, and treats seeds that have not run as passed. This can only hide failures, so a test that
stops early is wrong no more often than one that runs all seeds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import Count, Evaluator
from pytest_tarl.stressing.guarantee import hopeful, most_passed

LOOKS = (16, 32, 64, 128)  # a test counts the failures among these numbers of seeds, from the first seed on
# share of the risk for each of LOOKS; the last gets the most, because more seeds can show smaller failure rates
SPENT = (0.1, 0.15, 0.25, 0.5)
BLOCK = 8  # number of episodes between two checks for a decision


@dataclass
class RateTests:
    """The tests of a chain for drifts that fail too often; `risk` is the error probability of each test."""

    evaluator: Evaluator
    pool: str
    risk: float
    ran: set[int] = field(default_factory=set)  # seeds that ran under the last confirmed drift
    failed: set[int] = field(default_factory=set)  # the seeds in `ran` whose episodes failed

    def confirm(self, point: Point) -> bool:
        """Return whether fresh episodes show that too few pass at a point. Raise BudgetSpentError."""
        looks, groups = self._looks(), self._groups()
        outcomes: dict[int, bool] = {}  # seed number → whether its episode failed
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
        """Return pairs of a number of seeds and how many of them must fail to show that the drift fails too often."""
        given = self.evaluator.guarantee
        return [
            (size, size - most_passed(given, size, self.risk * share, "rate"))
            for size, share in zip(LOOKS, SPENT, strict=True)
        ]

    def _estimate(self, outcomes: Mapping[int, bool]) -> tuple[float, int]:
        """Estimate the number of failures under this drift; return it with the number of seeds that it covers.

        The estimate covers the seeds that ran under this drift or the previous one. Seeds that failed under the
        previous drift are estimated separately from those that passed, because only some of each may have run under
        this drift. If none of the passed seeds has run again, they all count as passed.
        """
        new = [failed for row, failed in outcomes.items() if row not in self.ran]
        failures, seeds = float(sum(new)), len(new)
        for group in (self.failed, self.ran - self.failed):
            found = [outcomes[row] for row in group if row in outcomes]
            failures += len(group) * sum(found) / len(found) if found else 0.0
            seeds += len(group)
        return failures, seeds

    def _groups(self) -> list[list[int]]:
        """Return the seeds in the order in which they run.

        First the seeds that failed under the previous drift, then those that did not run under it, then the rest.
        """
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
    """Forecast the failures of all seeds: remaining seeds fail slightly more often than recent ones.

    If there are several groups, the first has the seeds that failed under another drift. Its failures say little about
    the other groups, whose remaining seeds are therefore all assumed to fail.
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
