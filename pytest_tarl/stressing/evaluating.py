"""Run episodes under drifts within a budget, and store their outcomes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from statistics import fmean
from time import monotonic
from typing import NamedTuple

from pytest_tarl.rollout import EpisodePlan, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Point, Space
from pytest_tarl.stressing.guarantee import (
    Evidence,
    Guarantee,
    Outcome,
    Part,
    examined,
    hopeless,
    margin_of,
    outcome,
    refuted,
)

SIZES = (4, 8, 16, 32)  # the search checks for a decision after these numbers of episodes at a drift
FRESH = (16, 32)  # a test along a ray checks for a decision after these numbers of fresh episodes
# number of episodes at each new drift of the search in several directions; the model combines them, so a few suffice
GLANCE = 2
# successive drifts of this search start at different seeds, among the first TURNS ones
TURNS = 16
# a test of a combination checks for a decision after these numbers of fresh episodes; more episodes can show failures
# nearer to the boundary
NEAREST = (16, 32, 64)
# shares of the risk for these checks; the last check gets the most, because it can show the smallest excess
SPENT = (0.1, 0.2, 0.7)
SEARCH = "search"  # name of the pool of seeds for the search
# name of the pool of fresh seeds for all rays; each chain of combinations has its own pool
RAYS = "rays"

Progress = Callable[[int, int, str], None]


class Count(NamedTuple):
    """The estimated number of failures among some episodes of a drift."""

    point: Point
    failed: float
    episodes: int


class BudgetSpentError(Exception):
    """The remaining budget does not cover the next episodes."""


@dataclass
class Evaluator:
    """Run episodes at points of the space `drift`, and keep their outcomes.

    All points use the same seeds of a pool, so their episodes can be compared in pairs. `spent` counts the episodes.
    """

    rollout: Rollout
    space: Space
    drift: str
    guarantee: Guarantee
    seed: int
    budget: int
    progress: Progress
    spent: int = 0
    short: bool = False  # whether a result is missing because the budget ran out
    seconds: float | None = None  # time limit in seconds, in addition to the number of episodes
    begun: float = field(default_factory=lambda: monotonic())  # a lambda because tests replace `monotonic`
    _known: dict[tuple[str | float, ...], list[Outcome]] = field(default_factory=dict)
    _first: dict[tuple[float, ...], int] = field(default_factory=dict)
    _measured: dict[tuple[float, ...], tuple[float, float]] = field(default_factory=dict)
    _released: list[str] = field(default_factory=list)
    _orders: dict[tuple[str | float, ...], list[int]] = field(default_factory=dict)
    _counts: dict[str, list[Count]] = field(default_factory=dict)
    _unpaired: set[str] = field(default_factory=set)

    @contextmanager
    def limited(self, share: float) -> Iterator[None]:
        """Limit the block to this share of the whole budget.

        When the share is spent, end the block without an error and set `short`.
        """
        whole, self.budget = self.budget, min(self.budget, round(share * self.budget))
        time, self.seconds = self.seconds, None if self.seconds is None else share * self.seconds
        try:
            yield
        except BudgetSpentError:
            self.short = True
        finally:
            self.budget, self.seconds = whole, time

    @property
    def left(self) -> int:
        """Return how many more episodes the budget allows; a time limit is converted with the mean time per episode."""
        if self.seconds is None:
            return self.budget - self.spent
        passed = monotonic() - self.begun
        return int(self.spent * max(self.seconds - passed, 0.0) / max(passed, 1e-9))

    def glance(self, point: Point, turn: int = 0) -> Evidence:
        """Return the evidence at a point from GLANCE episodes; if the point is new, `turn` selects the seeds.

        Different drifts start at different seeds, so that a few unusual seeds do not distort the results of all drifts.
        Raise BudgetSpentError.
        """
        if point != self.space.nominal and not self.searched(point):
            self._first[tuple(point.values())] = turn * GLANCE % TURNS
        return self._evidence(point, GLANCE)

    def examine(self, point: Point, most: int) -> Evidence:
        """Return the evidence at a point from at most `most` episodes; stop when it is decided.

        Raise BudgetSpentError before episodes that exceed the budget.
        """
        found = self._evidence(point, SIZES[0])
        for size in SIZES[1:]:
            if found.result != "open" or size > most:
                break
            found = self._evidence(point, size)
        return found

    def searched(self, point: Point) -> bool:
        """Return whether the search has run an episode at a point."""
        return bool(self._known.get((SEARCH, *point.values())))

    def known(self, point: Point) -> Evidence:
        """Return the evidence at a point from the search episodes that have already run there."""
        outcomes = self._known[(SEARCH, *point.values())]
        return examined(self.guarantee, outcomes, self._paired(point, len(outcomes)))

    def confirm(
        self,
        point: Point,
        pool: str,
        risk: float,
        sizes: Sequence[int] = FRESH,
        shares: Sequence[float] | None = None,
        part: Part = "both",
        *,
        strict: bool = False,
        least: float | None = None,
    ) -> bool:
        """Return whether fresh episodes show that the guarantee fails at a point, with error probability `risk`.

        Episodes are paired with the nominal episodes of the same seeds. Several points may use the same pool, as long
        as they were chosen without knowing its outcomes.

        - `sizes`: the test checks for a decision after each of these numbers of episodes.
        - `shares`: the share of `risk` for each check; all equal by default.
        - `part`: test only this part of the guarantee, at the full risk. It must be chosen independently of the pool.
        - `strict`: stop even earlier when the test has little chance left to show a failure (see `hopeless`).
        - `least`: a lower bound on the nominal mean reward. The test compares with it instead of nominal episodes.

        Raise BudgetSpentError.
        """
        if least is not None:
            self._unpaired.add(pool)
        risks = [risk * share for share in shares or [1.0 / len(sizes)] * len(sizes)]
        for size, share in zip(sizes, risks, strict=True):
            outcomes = self._of(pool, point, size)
            nominal = (
                self._of(pool, self.space.nominal, size) if least is None else [Outcome(True, least)] * size
            )
            if refuted(self.guarantee, outcomes, nominal, share, part):
                return True
            if hopeless(self.guarantee, outcomes, nominal, sizes[-1], risks[-1], part, strict=strict):
                return False
        return False

    def _evidence(self, point: Point, count: int) -> Evidence:
        # nominal episodes run first, because each outcome is paired with one
        nominal = self._paired(point, count)
        return examined(self.guarantee, self.common(point, count), nominal)

    def rows(self, point: Point, count: int) -> list[int]:
        """Return the numbers of the first `count` seeds that the search uses at a point."""
        first = self._first.get(tuple(point.values()), 0)
        return [*range(first, TURNS), *range(first), *range(TURNS, count)][:count]

    def _paired(self, point: Point, count: int) -> list[Outcome]:
        """Return the nominal outcomes for the first `count` seeds of a point. Raise BudgetSpentError."""
        rows = self.rows(point, count)
        nominal = self._of(SEARCH, self.space.nominal, max(rows) + 1)
        return [nominal[row] for row in rows]

    def measured(self, point: Point) -> tuple[float, float]:
        """Return the margin at a point and its approximate standard deviation, from the episodes that `losses` uses.

        Raise KeyError if there is no such episode.
        """
        outcomes, nominal = self._learned(point)
        key = (len(outcomes), *point.values())
        if key not in self._measured:
            self._measured[key] = margin_of(self.guarantee, outcomes, nominal)
        return self._measured[key]

    def release(self, pool: str) -> None:
        """Let the model of the search learn from a pool of fresh episodes that no later test uses."""
        if pool not in self._released:
            self._released.append(pool)

    def knows(self, point: Point) -> bool:
        """Return whether `losses` has an episode at a point; it has none if the budget ran out first."""
        return any(self._pairs(pool, point)[0] for pool in (SEARCH, *self._released))

    @property
    def fresh_pools(self) -> list[str]:
        """Return the pools of fresh seeds: that of the rays, and the released ones."""
        return [RAYS, *self._released]

    def losses(self, point: Point) -> tuple[list[float], int]:
        """Return the losses at a point that the model may learn from, and the number of failed episodes.

        These are the episodes of the search and of the released pools. A loss is the difference from the nominal
        episode with the same seed, in units of the tolerated loss; it is positive if the episode earned less. Raise
        KeyError if there is no such episode.
        """
        unit = self.guarantee.tolerance
        outcomes, nominal = self._learned(point)
        lost = [before.total - after.total for after, before in zip(outcomes, nominal, strict=True)]
        shares = [one / unit if unit > 0.0 else 2.0 * (one > 0.0) for one in lost]
        return shares, sum(not one.passed for one in outcomes)

    def totals(self, point: Point) -> list[tuple[float, float]]:
        """Return the rewards of the search episodes at a point, each with the nominal reward of the same seed."""
        return [(one.total, usual.total) for one, usual in zip(*self._pairs(SEARCH, point), strict=True)]

    @property
    def usual_mean(self) -> float:
        """Return the mean reward of the nominal episodes of the search. Raise StatisticsError if there are none."""
        return fmean(one.total for one in self._known.get((SEARCH, *self._usual), []))

    def sources(self, point: Point) -> list[tuple[str, int]]:
        """Return the pool and seed number of each episode of `losses`, in the same order."""
        return [
            (pool, row)
            for pool in (SEARCH, *self._released)
            for row in self._rows(pool, point, len(self._pairs(pool, point)[0]))
        ]

    def _learned(self, point: Point) -> tuple[list[Outcome], list[Outcome]]:
        """Return the outcomes at a point that the model may learn from, and the nominal ones of the same seeds."""
        pairs = [self._pairs(pool, point) for pool in (SEARCH, *self._released)]
        outcomes, nominal = ([*chain.from_iterable(part)] for part in zip(*pairs, strict=True))
        if not outcomes:
            raise KeyError(tuple(point.values()))
        return outcomes, nominal

    def _pairs(self, pool: str, point: Point) -> tuple[Sequence[Outcome], Sequence[Outcome]]:
        """Return a pool's outcomes at a point and the nominal outcomes of the same seeds; skip seeds without both."""
        outcomes = self._known.get((pool, *point.values()))
        if not outcomes:
            return (), ()
        nominal = self._nominal(pool, len(outcomes))
        rows = [row for row in self._rows(pool, point, len(outcomes)) if row < len(nominal)]
        return outcomes[: len(rows)], [nominal[row] for row in rows]

    def _nominal(self, pool: str, count: int) -> Sequence[Outcome]:
        """Return a pool's nominal outcomes; if it has none, use the recorded mean for each."""
        if pool in self._unpaired:
            return [Outcome(True, fmean(self.guarantee.totals))] * count
        return self._known.get((pool, *self._usual), [])

    @cached_property
    def _usual(self) -> tuple[float, ...]:
        return tuple(self.space.nominal.values())

    def _rows(self, pool: str, point: Point, count: int) -> Sequence[int]:
        """Return the first `count` seed numbers of a pool at a point, in the order in which they run."""
        if pool == SEARCH:
            return self.rows(point, count)
        return self._orders.get((pool, *point.values()), range(count))[:count]

    def ordered(self, pool: str, point: Point, rows: Sequence[int]) -> dict[int, Outcome]:
        """Run the seeds `rows` of a fresh pool at a point; return all outcomes there by seed number.

        Raise BudgetSpentError if the budget does not cover the missing ones.
        """
        key: tuple[str | float, ...] = (pool, *point.values())
        known, order = self._known.setdefault(key, []), self._orders.setdefault(key, [])
        missing = [row for row in rows if row not in order]
        known += self.singly(pool, [point] * len(missing), missing)
        order += missing
        return dict(zip(order, known, strict=True))

    def count(self, pool: str, count: Count) -> None:
        """Store the estimated number of failures of a pool; it replaces the drift's earlier estimate.

        The model learns from the estimate once the pool is released.
        """
        known = self._counts.setdefault(pool, [])
        self._counts[pool] = [*(one for one in known if one.point != count.point), count]

    @property
    def counts(self) -> list[Count]:
        """Return the estimated numbers of failures in the released pools."""
        return [one for pool in self._released for one in self._counts.get(pool, [])]

    def common(self, point: Point, count: int) -> Sequence[Outcome]:
        """Return the outcomes of the first `count` seeds of the search at a point.

        Raise BudgetSpentError if the budget does not cover the missing ones.
        """
        return self._of(SEARCH, point, count)

    def fresh(self, point: Point, count: int) -> Sequence[Outcome]:
        """Return the outcomes of the first `count` confirmation seeds of the rays. Raise BudgetSpentError."""
        return self._of(RAYS, point, count)

    def affords(self, point: Point, count: int, paired: int) -> bool:
        """Return whether the budget covers `count` fresh and `paired` nominal episodes at a point.

        Set `short` if it does not. Episodes that have already run are free.
        """
        wanted = ((point, count), (self.space.nominal, paired))
        missing = (count - len(self._known.get((RAYS, *at.values()), ())) for at, count in wanted)
        affordable = sum(max(one, 0) for one in missing) <= self.left
        self.short |= not affordable
        return affordable

    def _of(self, pool: str, point: Point, count: int) -> Sequence[Outcome]:
        known = self._known.setdefault((pool, *point.values()), [])
        if len(known) < count:
            missing = self._seeds(pool, point, count)[len(known) :]
            known += self._run([point] * len(missing), missing)
        return known[:count]

    def _seeds(self, pool: str, point: Point, count: int) -> list[int]:
        """Return the first `count` seeds of a pool at a point, in the order in which they run."""
        rows = self._rows(pool, point, count)
        seeds = episode_seeds(self.seed, f"stress {self.drift} {pool}", max(rows, default=-1) + 1)
        return [seeds[row] for row in rows]

    def recalled(self, pool: str, point: Point) -> list[tuple[EpisodePlan, bool]]:
        """Return the plan of each episode that a pool ran at a point, and whether the episode failed.

        An episode fails if it does not pass, or if it loses more than the tolerated reward compared with the nominal
        episode of the same seed.
        """
        known = self._known.get((pool, *point.values()), [])
        rows = self._rows(pool, point, len(known))
        usual = self._nominal(pool, len(known))
        seeds = self._seeds(pool, point, len(known))
        return [
            (
                EpisodePlan(seed, self.drift, point=point),
                not one.passed
                or (row < len(usual) and usual[row].total - one.total > self.guarantee.tolerance),
            )
            for row, seed, one in zip(rows, seeds, known, strict=True)
        ]

    def singly(self, pool: str, points: Sequence[Point], rows: Sequence[int]) -> list[Outcome]:
        """Return the outcome of one episode at each point; point i uses seed number `rows[i]`.

        Raise BudgetSpentError.
        """
        seeds = episode_seeds(self.seed, f"stress {self.drift} {pool}", max(rows, default=-1) + 1)
        return self._run(points, [seeds[row] for row in rows])

    def _run(self, points: Sequence[Point], seeds: Sequence[int]) -> list[Outcome]:
        if self.spent + len(seeds) > self.budget:
            raise BudgetSpentError
        plans = (
            EpisodePlan(seed, self.drift, point=point) for point, seed in zip(points, seeds, strict=True)
        )
        outcomes = []
        for pending in in_order(self.rollout, plans):
            if self.seconds is not None and monotonic() - self.begun > self.seconds:
                raise BudgetSpentError
            outcomes.append(outcome(pending.result()))
            self.spent += 1
            self.progress(self.spent, self.budget, f"{self.drift} stress")
        return outcomes
