"""Run the episodes of drifts, within a budget."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic

from pytest_tarl.errors import RecordingError
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Rollout, in_order
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.spaces import Point, Space
from pytest_tarl.stressing.guarantee import (
    Evidence,
    Guarantee,
    Outcome,
    examined,
    hopeless,
    margin_of,
    refuted,
)

SIZES = (4, 8, 16, 32)  # episodes at a drift after which the search decides
FRESH = (16, 32)  # episodes on fresh seeds after which a failure along a ray is confirmed or not
NEAREST = (
    16,
    32,
    64,
)  # the same for a combination; more episodes can confirm failures nearer to the boundary
RAYS = "rays"  # name of the fresh seeds that all rays share

Progress = Callable[[int, int, str], None]


class BudgetSpentError(Exception):
    """The budget does not suffice for the next episodes."""


@dataclass
class Evaluator:
    """Run drifts of the space `drift` on pools of common seeds, and remember the outcomes; `spent` counts episodes."""

    rollout: Rollout
    space: Space
    drift: str
    guarantee: Guarantee
    seed: int
    budget: int
    progress: Progress
    spent: int = 0
    short: bool = False  # whether a result was left out because the budget did not suffice
    seconds: float | None = None  # a time limit in addition to that of the episodes
    begun: float = field(default_factory=lambda: monotonic())  # lambda: tests replace `monotonic`
    _known: dict[tuple[str | float, ...], list[Outcome]] = field(default_factory=dict)
    _measured: dict[tuple[float, ...], tuple[float, float]] = field(default_factory=dict)

    @contextmanager
    def limited(self, share: float) -> Iterator[None]:
        """End the block without an error once this share of the whole budget is spent; set `short` in that case."""
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
        """Return how many episodes the budget allows, at the speed so far if it is a time."""
        if self.seconds is None:
            return self.budget - self.spent
        passed = monotonic() - self.begun
        return int(self.spent * max(self.seconds - passed, 0.0) / max(passed, 1e-9))

    def examine(self, point: Point, most: int) -> Evidence:
        """Return the evidence at a point after at most `most` episodes; end early once it is decided.

        Raise BudgetSpentError before an episode that the budget does not cover.
        """
        found = self._evidence(point, SIZES[0])
        for size in SIZES[1:]:
            if found.result != "open" or size > most:
                break
            found = self._evidence(point, size)
        return found

    def confirm(self, point: Point, pool: str, risk: float, sizes: Sequence[int] = FRESH) -> bool:
        """Return whether the fresh seeds of a pool, paired with nominal runs, show at `risk` that the guarantee fails.

        A pool may serve several points if none of them was chosen by its outcomes. The test ends after the first of
        `sizes` at which the failure is shown, or hardly can be any more; the risk is divided among them.
        """
        share = risk / len(sizes)
        for size in sizes:
            outcomes = self._of(pool, point, size)
            nominal = self._of(pool, self.space.nominal, size)
            if refuted(self.guarantee, outcomes, nominal, share):
                return True
            if hopeless(self.guarantee, outcomes, nominal, sizes[-1], share):
                return False
        return False

    def _evidence(self, point: Point, count: int) -> Evidence:
        nominal = self.common(self.space.nominal, count)  # first, as no point may have more outcomes
        return examined(self.guarantee, self.common(point, count), nominal)

    def measured(self, point: Point) -> tuple[float, float]:
        """Return the margin of all episodes that the search ran at a point, and its approximate standard deviation."""
        outcomes = self._known[("search", *point.values())]
        key = (len(outcomes), *point.values())
        if key not in self._measured:
            self._measured[key] = margin_of(
                self.guarantee, outcomes, self.common(self.space.nominal, len(outcomes))
            )
        return self._measured[key]

    def losses(self, point: Point) -> tuple[list[float], int]:
        """Return the losses of all episodes that the search ran at a point, and how many of the episodes failed.

        A loss is relative to the nominal episode of the same seed, as a share of the tolerated loss.
        """
        outcomes = self._known[("search", *point.values())]
        unit = self.guarantee.tolerance
        pairs = zip(outcomes, self.common(self.space.nominal, len(outcomes)), strict=True)
        lost = [before.total - after.total for after, before in pairs]
        shares = [one / unit if unit > 0.0 else 2.0 * (one > 0.0) for one in lost]
        return shares, sum(not one.passed for one in outcomes)

    def common(self, point: Point, count: int) -> Sequence[Outcome]:
        """Return the outcomes on the search's first seeds. Raise BudgetSpentError if the budget does not cover them."""
        return self._of("search", point, count)

    def fresh(self, point: Point, count: int) -> Sequence[Outcome]:
        """Return outcomes on the seeds that confirm results of rays. Raise BudgetSpentError."""
        return self._of(RAYS, point, count)

    def affords(self, point: Point, count: int, paired: int) -> bool:
        """Return whether the budget covers `count` fresh episodes at a point, `paired` of them with nominal ones.

        If it does not, `short` is set.
        """
        wanted = ((point, count), (self.space.nominal, paired))
        missing = (count - len(self._known.get((RAYS, *at.values()), ())) for at, count in wanted)
        affordable = sum(max(one, 0) for one in missing) <= self.left
        self.short |= not affordable
        return affordable

    def _of(self, pool: str, point: Point, count: int) -> Sequence[Outcome]:
        known = self._known.setdefault((pool, *point.values()), [])
        if len(known) < count:
            seeds = episode_seeds(self.seed, f"stress {self.drift} {pool}", count)
            missing = seeds[len(known) :]
            known += self._run([point] * len(missing), missing)
        return known[:count]

    def recalled(self, pool: str, point: Point) -> list[tuple[EpisodePlan, bool]]:
        """Return the plans of the episodes that a pool ran at a point, and whether each fails.

        An episode fails if it does not pass, or loses more than tolerated against the nominal one on its seed.
        """
        known = self._known.get((pool, *point.values()), [])
        nominal = self._known.get((pool, *self.space.nominal.values()), [])
        seeds = episode_seeds(self.seed, f"stress {self.drift} {pool}", len(known))
        return [
            (
                EpisodePlan(seed, self.drift, point=point),
                not one.passed
                or (place < len(nominal) and nominal[place].total - one.total > self.guarantee.tolerance),
            )
            for place, (seed, one) in enumerate(zip(seeds, known, strict=True))
        ]

    def singly(self, pool: str, points: Sequence[Point], rows: Sequence[int]) -> list[Outcome]:
        """Return the outcome of each point on one seed: the seed with the number of its row. Raise BudgetSpentError."""
        seeds = episode_seeds(self.seed, f"stress {self.drift} {pool}", max(rows) + 1)
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


def outcome(run: EpisodeRun) -> Outcome:
    """Return the outcome of an episode; a node that never waits has failed. Raise RecordingError for a broken test."""
    if run.broken and not run.stuck:
        where = ", ".join(f"{name}={number:g}" for name, number in (run.plan.point or {}).items())
        raise RecordingError(
            f"An episode at {where} (seed {run.plan.seed}) failed outside the mission:\n{run.broken}"
        )
    return Outcome(run.passed and not run.stuck, float(run.trace.reward.sum()))
