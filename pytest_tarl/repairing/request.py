"""A request for a repair: the degraded test, and the reward that a repair must reach."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from statistics import fmean, stdev

from pytest_tarl.comparing import Online
from pytest_tarl.drifts import Drift, sizes
from pytest_tarl.learning.drift import PASS_RATE_LOSS
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.model import Comparison
from pytest_tarl.options import Options
from pytest_tarl.recording import Progress
from pytest_tarl.rollout import Rollout
from pytest_tarl.searching.accept import Reference
from pytest_tarl.searching.search import Goal, Pair
from tarl_lint.api import Analysis

SMALL = 0.05  # margin as a share of the loss, used if designed missions have no reward


@dataclass(frozen=True)
class Neighbour:
    """Another recorded test: its node files, a function to run it, the tolerated loss per episode."""

    test: str
    nodes: tuple[Path, ...]
    rollout: Rollout
    fixture: Fixture
    margin: float
    # the drift to repair, if the drift is permanent and this test declares it as well
    drift: str | None = None


@dataclass(frozen=True)
class Order:
    """A degraded test under one drift: a function that runs it, its recording, and where patches go."""

    rollout: Rollout
    analysis: Analysis
    root: Path  # folder to which paths in the analysis are relative
    fixture: Fixture
    online: Online
    options: Options
    progress: Progress
    patches: Path
    recorded: Path | None = None  # file of the recording
    # called only after a candidate has passed all other checks
    neighbours: Callable[[], Sequence[Neighbour]] = tuple
    world: Drift | None = None  # the declaration of the drift
    declared: tuple[float, float] | None = None  # declared range of the total reward of an episode
    searched: Goal | None = None  # the goal after `enriching` has added seeds, if it ran

    @property
    def comparison(self) -> Comparison:
        """Return the comparison with the drifted world."""
        return self.online.comparison

    @property
    def drift(self) -> str | None:
        """Return the drift scenario to repair."""
        return self.comparison.drift

    @property
    def permanent(self) -> bool:
        """Return whether the world has changed permanently, so that the designed world is not tested."""
        return self.comparison.permanent

    @cached_property
    def reference(self) -> Reference:
        """Return the recorded designed missions. Repairs are compared with them."""
        offline, verdict = self.fixture.sample, self.comparison.verdict
        margin = verdict.tolerance or SMALL * verdict.loss
        totals, passed = offline.total.tolist(), float(offline.passed.mean())
        low, high = self.declared if self.declared is not None else (self.worst, None)
        return Reference(totals, passed, margin, min(low, self.worst), high)

    @cached_property
    def goal(self) -> Goal:
        """Return the goal of the search."""
        if self.searched is not None:
            return self.searched
        online = self.online.recorded.sample
        columns = zip(online.seeds, online.total.tolist(), online.steps.tolist(), strict=True)
        pairs = [Pair(seed, total, steps) for seed, total, steps in columns]
        found = goal(pairs, self.reference, self.comparison.verdict.loss)
        found = replace(found, steps=float(self.fixture.sample.steps.mean()))
        if not self.comparison.sizes or self.world is None or self.drift is None:
            return found
        part = next(iter(self.comparison.sizes))
        drawn = [(sizes(self.world, self.drift, pair.seed)[part], at) for at, pair in enumerate(found.pairs)]
        return replace(found, pairs=tuple(found.pairs[at] for at in spread(drawn)), ranged=True)

    @cached_property
    def worst(self) -> float:
        """Return the lowest total of any recorded episode, which a candidate gets if it breaks the test."""
        return float(min(self.fixture.sample.total.min(), self.online.recorded.sample.total.min()))


def spread(drawn: Sequence[tuple[float, int]]) -> Iterator[int]:
    """Yield the indices of (size, index) pairs, ordered so that the first few pairs span the range of sizes."""
    parts = [[index for _, index in sorted(drawn)]]
    while parts:
        part = parts.pop(0)
        if part:
            middle = len(part) // 2
            yield part[middle]
            parts += [part[:middle], part[middle + 1 :]]


def goal(online: Sequence[Pair], reference: Reference, loss: float) -> Goal:
    """Return the goal: drifted episodes with a loss (worst last), and the totals to reach."""
    spread = stdev(reference.totals) if len(reference.totals) > 1 else 0.0
    near = reference.mean - max(reference.margin, 2 * spread, 0.1 * loss)
    lost = sorted((pair for pair in online if pair.total < near), key=lambda pair: -pair.total)
    return Goal(
        pairs=tuple(lost) or tuple(online),
        near=near,
        enough=reference.mean - max(reference.margin, spread),
        online=fmean(pair.total for pair in online),
        passing=reference.pass_rate >= 1 - PASS_RATE_LOSS,
        margin=reference.margin,
    )
