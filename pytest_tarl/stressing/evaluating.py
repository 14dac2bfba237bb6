"""Run episodes under drifts within a budget, and keep their outcomes."""

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

SIZES = (4, 8, 16, 32)  # numbers of episodes at a drift after which the search checks for a decision
FRESH = (16, 32)  # numbers of fresh episodes after which a test along a ray checks for a decision
# number of episodes at each new drift of the search in several directions; few suffice, because a model combines them
GLANCE = 2
# the drifts of this search start, in turn, at different seeds among the first TURNS ones
TURNS = 16
# numbers of fresh episodes after which a test of a combination checks for a decision; more episodes can show failures
# nearer to the boundary
NEAREST = (16, 32, 64)
# shares of the risk for these checks; the last share is the largest, because the check with the most episodes can show
# the smallest excess
SPENT = (0.1, 0.2, 0.7)
SEARCH = "search"  # name of the pool of seeds on which the search runs
# name of the pool of fresh seeds that all rays share; each chain of combinations has its own pool
RAYS = "rays"

Progress = Callable[[int, int, str], None]


class Count(NamedTuple):
    """For a drift, the estimated number of failures among a number of episodes."""

    point: Point
    failed: float
    episodes: int


class BudgetSpentError(Exception):
    """Raised if the remaining budget does not cover the next episodes."""


@dataclass
class Evaluator:
    """Run episodes at points of the space `drift`, and keep their outcomes.

    All points share the seeds of a pool, so their episodes can be compared in pairs. `spent` counts the episodes.
    """

    rollout: Rollout
    space: Space
    drift: str
    guarantee: Guarantee
    seed: int
    budget: int
    progress: Progress
    spent: int = 0
    short: bool = False  # whether a result is missing because the budget did not cover it
    seconds: float | None = None  # time limit in seconds, in addition to the number of episodes
    begun: float = field(default_factory=lambda: monotonic())  # a lambda, because tests replace `monotonic`
    _known: dict[tuple[str | float, ...], list[Outcome]] = field(default_factory=dict)
    _first: dict[tuple[float, ...], int] = field(default_factory=dict)
    _measured: dict[tuple[float, ...], tuple[float, float]] = field(default_factory=dict)
    _released: list[str] = field(default_factory=list)
    _orders: dict[tuple[str | float, ...], list[int]] = field(default_factory=dict)
    _counts: dict[str, list[Count]] = field(default_factory=dict)
    _unpaired: set[str] = field(default_factory=set)

    @contextmanager
    def limited(self, share: float) -> Iterator[None]:
        """Run the block with only this share of the whole budget.

        If the share is spent, end the block without an error and set `short`.
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
        """Return how many more episodes the budget allows; a time limit counts at the mean speed."""
        if self.seconds is None:
            return self.budget - self.spent
        passed = monotonic() - self.begun
        return int(self.spent * max(self.seconds - passed, 0.0) / max(passed, 1e-9))

    def glance(self, point: Point, turn: int = 0) -> Evidence:
        """Return the evidence at a point from GLANCE episodes; if the point is new, `turn` selects the seeds.

        The drifts take turns with different seeds, so that a few unusual seeds do not distort the results of all
        drifts. Raise BudgetSpentError.
        """
        if point != self.space.nominal and not self.searched(point):
            self._first[tuple(point.values())] = turn * GLANCE % TURNS
        return self._evidence(point, GLANCE)

    def examine(self, point: Point, most: int) -> Evidence:
        """Return the evidence at a point from at most `most` episodes; stop once it is decided.

        Raise BudgetSpentError before episodes that the budget does not cover.
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
        """Return the evidence at a point from the episodes of the search that already ran there."""
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
        """Return whether fresh episodes show, with error probability `risk`, that the guarantee fails at a point.

        Episodes are paired with the nominal episodes of the same seeds. Several points may share a pool, provided that
        the outcomes of the pool did not affect the choice of the points. The test checks for a decision after each
        number of episodes in `sizes`. Each check has its share of `risk`; without `shares`, all checks have the same
        share. With `part`, only this part of the guarantee is tested, at the whole risk; the choice of the part must
        not depend on the pool. The test also stops when it has little chance left to show a failure; with `strict`,
        this happens earlier (see `hopeless`). With `least`, a lower bound of the nominal mean reward, the test compares
        with this bound and needs no nominal episodes. Raise BudgetSpentError.
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
        # run the nominal episodes first, because each outcome is paired with a nominal one
        nominal = self._paired(point, count)
        return examined(self.guarantee, self.common(point, count), nominal)

    def rows(self, point: Point, count: int) -> list[int]:
        """Return the numbers of the first `count` seeds that the search uses at a point."""
        first = self._first.get(tuple(point.values()), 0)
        return [*range(first, TURNS), *range(first), *range(TURNS, count)][:count]

    def _paired(self, point: Point, count: int) -> list[Outcome]:
        """Return the nominal outcomes with the first `count` seeds of a point. Raise BudgetSpentError."""
        rows = self.rows(point, count)
        nominal = self._of(SEARCH, self.space.nominal, max(rows) + 1)
        return [nominal[row] for row in rows]

    def measured(self, point: Point) -> tuple[float, float]:
        """Return the margin at a point and its approximate standard deviation, from the episodes of `losses`.

        Raise KeyError if there is no such episode.
        """
        outcomes, nominal = self._learned(point)
        key = (len(outcomes), *point.values())
        if key not in self._measured:
            self._measured[key] = margin_of(self.guarantee, outcomes, nominal)
        return self._measured[key]

    def release(self, pool: str) -> None:
        """Let the model of the search learn from the fresh episodes of a pool that no later test uses."""
        if pool not in self._released:
            self._released.append(pool)

    def knows(self, point: Point) -> bool:
        """Return whether `losses` has an episode at a point; it has none if the budget was spent before."""
        return any(self._pairs(pool, point)[0] for pool in (SEARCH, *self._released))

    @property
    def fresh_pools(self) -> list[str]:
        """Return the pools of fresh seeds: the pool of the rays and the released pools."""
        return [RAYS, *self._released]

    def losses(self, point: Point) -> tuple[list[float], int]:
        """Return the losses at a point that the model may learn, and how many episodes failed.

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
        """Return the rewards of a point's search episodes, each with its seed's nominal reward."""
        return [(one.total, usual.total) for one, usual in zip(*self._pairs(SEARCH, point), strict=True)]

    @property
    def usual_mean(self) -> float:
        """Return the mean reward of the nominal episodes of the search. Raise StatisticsError if there are none."""
        return fmean(one.total for one in self._known.get((SEARCH, *self._usual), []))

    def sources(self, point: Point) -> list[tuple[str, int]]:
        """Return the pool and the number of the seed of each episode of `losses`, in the same order."""
        return [
            (pool, row)
            for pool in (SEARCH, *self._released)
            for row in self._rows(pool, point, len(self._pairs(pool, point)[0]))
        ]

    def _learned(self, point: Point) -> tuple[list[Outcome], list[Outcome]]:
        """Return the outcomes at a point that the model may learn, and their seeds' nominal ones."""
        pairs = [self._pairs(pool, point) for pool in (SEARCH, *self._released)]
        outcomes, nominal = ([*chain.from_iterable(part)] for part in zip(*pairs, strict=True))
        if not outcomes:
            raise KeyError(tuple(point.values()))
        return outcomes, nominal

    def _pairs(self, pool: str, point: Point) -> tuple[Sequence[Outcome], Sequence[Outcome]]:
        """Return a pool's outcomes at a point and the nominal outcomes with the same seeds; skip other seeds."""
        outcomes = self._known.get((pool, *point.values()))
        if not outcomes:
            return (), ()
        nominal = self._nominal(pool, len(outcomes))
        rows = [row for row in self._rows(pool, point, len(outcomes)) if row < len(nominal)]
        return outcomes[: len(rows)], [nominal[row] for row in rows]

    def _nominal(self, pool: str, count: int) -> Sequence[Outcome]:
        """Return a pool's nominal outcomes; without any, the recorded mean replaces each."""
        if pool in self._unpaired:
            return [Outcome(True, fmean(self.guarantee.totals))] * count
        return self._known.get((pool, *self._usual), [])

    @cached_property
    def _usual(self) -> tuple[float, ...]:
        return tuple(self.space.nominal.values())

    def _rows(self, pool: str, point: Point, count: int) -> Sequence[int]:
        """Return the numbers of a pool's first `count` seeds at a point, in running order."""
        if pool == SEARCH:
            return self.rows(point, count)
        return self._orders.get((pool, *point.values()), range(count))[:count]

    def ordered(self, pool: str, point: Point, rows: Sequence[int]) -> dict[int, Outcome]:
        """Run the seeds `rows` of a fresh pool at a point; return all outcomes there by number.

        Raise BudgetSpentError if the budget does not cover the missing ones.
        """
        key: tuple[str | float, ...] = (pool, *point.values())
        known, order = self._known.setdefault(key, []), self._orders.setdefault(key, [])
        missing = [row for row in rows if row not in order]
        known += self.singly(pool, [point] * len(missing), missing)
        order += missing
        return dict(zip(order, known, strict=True))

    def count(self, pool: str, count: Count) -> None:
        """Store how many episodes of a pool fail (an estimate), instead of the drift's earlier one.

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
        """Return whether the budget covers `count` fresh episodes at a point and `paired` nominal ones.

        Set `short` if it does not. Episodes that already ran cost nothing.
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

        An episode fails if it does not pass, or if its reward is lower than that of the nominal episode with the same
        seed by more than the tolerated loss.
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
