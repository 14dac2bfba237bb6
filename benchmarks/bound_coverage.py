"""Measure how often bounds at 95 % confidence hold, over many samples from known distributions.

    python benchmarks/bound_coverage.py [--repetitions 2000]

Each row of the table is a distribution of an episode's total reward, and each column a number of episodes. A cell gives
the shares of samples in which the lower and the upper bound held. Exact bounds must hold in at least 94 % of the
samples, allowing for the benchmark's sampling error. There is no requirement for approximate bounds. For a loss, 200
recorded episodes are compared with new episodes of the same world; the column is the number of new episodes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from math import log, sqrt

import numpy as np

from pytest_tarl.learning.betting import bet
from pytest_tarl.learning.bounds import (
    Range,
    evidence_above,
    loss_between,
    mean_of,
    quantile_low,
    rate,
)
from pytest_tarl.learning.student import difference_bounds
from pytest_tarl.learning.tables import Floats
from pytest_tarl.model import Bound
from pytest_tarl.searching.accept import SCREEN
from pytest_tarl.seeds import generator

CONFIDENCE = 0.95
GOAL = 0.94
EPISODES = (8, 20, 50, 200)
ONLINE = (8, 20, 50)  # numbers of new episodes for losses without a range, whose bounds are slow to compute
OFFLINE = 200
QUANTILE = 0.05
LIMIT = 0.01  # margin of an acceptance test, as a share of the range
TRUTH = 2_000_000  # draws from which the true mean or quantile is computed

Generator = np.random.Generator
Held = tuple[bool, bool]


def zero_inflated(draws: Generator, n: int) -> Floats:
    """Draw total rewards, nine in ten of which are zero."""
    return np.clip(draws.exponential(2, n), 0, 20) * (draws.random(n) < 0.1)


def bimodal(draws: Generator, n: int) -> Floats:
    """Draw total rewards, one in twenty of which is far lower than the others."""
    return np.where(draws.random(n) < 0.05, -9.0, 5.0) + draws.uniform(-1, 1, n)


DRAWN: dict[str, tuple[Callable[[Generator, int], Floats], Range | None]] = {
    "normal": (lambda draws, n: draws.normal(0, 1, n), None),
    "exponential": (lambda draws, n: draws.exponential(1, n), None),
    "exponential cost": (lambda draws, n: -draws.exponential(1, n), None),
    "lognormal": (lambda draws, n: draws.lognormal(0, 1, n), None),
    "zero-inflated": (zero_inflated, Range(0, 20)),
    "bimodal": (bimodal, Range(-10, 10)),
    "bounded": (lambda draws, n: draws.beta(5, 1, n), Range(0, 1)),
    "skewed in its range": (lambda draws, n: np.clip(draws.exponential(1, n), 0, 10), Range(0, 10)),
    "bonus in 97 %": (lambda draws, n: (draws.random(n) < 0.97).astype(np.float64), Range(0, 1)),
}
RATES = (0.5, 0.9, 0.99)


@dataclass(frozen=True)
class World:
    """A distribution of total rewards, with checks whether the bounds from a sample hold."""

    name: str

    @property
    def declared(self) -> Range | None:
        """Return a range that contains all totals, or None."""
        return DRAWN[self.name][1]

    @cached_property
    def truth(self) -> tuple[float, float]:
        """Return the true mean and quantile."""
        many = self.drawn(generator(0, f"truth/{self.name}"), TRUTH)
        return float(np.mean(many)), float(np.quantile(many, QUANTILE))

    def drawn(self, draws: Generator, n: int) -> list[float]:
        """Return a sample."""
        totals: list[float] = DRAWN[self.name][0](draws, n).tolist()
        return totals

    def mean(self, draws: Generator, n: int, how: Range | None, anytime: bool = False) -> Held:
        """Return whether the bounds on the mean hold."""
        return holds(mean_of(self.drawn(draws, n), CONFIDENCE, how, anytime=anytime), self.truth[0])

    def quantile(self, draws: Generator, n: int) -> Held:
        """Return whether the bound on the quantile holds; True if the sample is too small for a bound."""
        low = quantile_low(self.drawn(draws, n), QUANTILE, CONFIDENCE)
        return low is None or low <= self.truth[1], True

    def loss(self, draws: Generator, n: int, how: Range | None) -> Held:
        """Return whether the bounds on a loss hold if the true loss is 0."""
        return holds(loss_between(self.drawn(draws, OFFLINE), self.drawn(draws, n), CONFIDENCE, how), 0.0)

    def limit(self, draws: Generator, n: int, how: Range) -> Held:
        """Return whether the acceptance test never accepts within n episodes if the true loss equals the margin."""
        margin = LIMIT * (how.high - how.low)
        least = how.low - self.truth[0] - margin
        away = self.truth[0] + margin
        known, seen = ([total - away for total in self.drawn(draws, m)] for m in (SCREEN, n))
        stakes = bet(margin, least, known)
        ends = range(1, n + 1, max(1, n // 50))
        return all(stakes.wealth(seen[:end]) < log(1 / (1 - CONFIDENCE)) for end in ends), True

    def welch(self, draws: Generator, n: int) -> Held:
        """Return whether Welch's bounds on the loss hold if the true loss is 0."""
        low, high = difference_bounds(self.drawn(draws, OFFLINE), self.drawn(draws, n), 1 - CONFIDENCE)
        return low <= 0.0, high >= 0.0


def holds(bound: Bound, truth: float) -> Held:
    """Return whether the lower and the upper bound hold."""
    return bound.low <= truth, truth <= bound.high


def rate_holds(p: float, draws: Generator, n: int) -> Held:
    """Return whether the bounds on a rate hold."""
    return holds(rate(int((draws.random(n) < p).sum()), n, CONFIDENCE), p)


def sequence_holds(p: float, draws: Generator, n: int) -> Held:
    """Return whether the bounds on a rate hold each time they are checked during n episodes."""
    passed = np.cumsum(draws.random(n) < p)
    barred = log(1 / (1 - CONFIDENCE))
    ends = range(1, n + 1, max(1, n // 50))
    low = all(evidence_above(int(passed[i - 1]), i, p) < barred for i in ends)
    return low, all(evidence_above(i - int(passed[i - 1]), i, 1 - p) < barred for i in ends)


@dataclass(frozen=True)
class Row:
    """How often a bound held in samples of a distribution, by number of episodes."""

    bound: str
    exact: bool
    world: str
    held: tuple[tuple[float, float], ...]

    def line(self) -> str:
        """Return the row of the table."""
        label = self.bound if self.exact else f"{self.bound} (approximate)"
        shares = [f"{low:.1%} / {high:.1%}" for low, high in self.held]
        return f"| {label} | {self.world} | {' | '.join([*shares, *[''] * (len(EPISODES) - len(shares))])} |"


def measured(
    bound: str,
    exact: bool,
    world: str,
    held: Callable[[Generator, int], Held],
    repetitions: int,
    sizes: tuple[int, ...] = EPISODES,
) -> Row:
    """Draw repeatedly, and count how often the bounds hold."""
    found = []
    for n in sizes:
        seen = np.array([held(generator(seed, f"{bound}/{world}/{n}"), n) for seed in range(repetitions)])
        low, high = seen.mean(axis=0).tolist()
        found.append((low, high))
    return Row(bound, exact, world, tuple(found))


def of_rate(p: float, repetitions: int) -> list[Row]:
    """Return the rows for a success rate."""
    name = f"{p:.0%} succeed"
    return [
        measured("rate, Clopper-Pearson", True, name, lambda d, n: rate_holds(p, d, n), repetitions),
        measured("rate, at any time", True, name, lambda d, n: sequence_holds(p, d, n), repetitions),
    ]


def of_world(name: str, repetitions: int, kinds: str) -> list[Row]:
    """Return the rows for a distribution of totals: exact bounds, approximate bounds, or both."""
    world = World(name)
    declared, fewer, few = world.declared, repetitions // 2, repetitions // 4
    found: list[Row] = []
    if kinds != "approximate":
        found.append(measured("quantile, order statistics", True, name, world.quantile, repetitions))
    if kinds != "approximate" and declared is not None:
        found += [
            measured("mean, betting", True, name, lambda d, n: world.mean(d, n, declared), repetitions),
            measured(
                "mean, betting, any time", True, name, lambda d, n: world.mean(d, n, declared, True), fewer
            ),
            measured(
                "above a limit, acceptance", True, name, lambda d, n: world.limit(d, n, declared), fewer
            ),
            measured("loss, betting", True, name, lambda d, n: world.loss(d, n, declared), fewer),
        ]
    if kinds == "exact":
        return found
    return [
        *found,
        measured("mean, Student", False, name, lambda d, n: world.mean(d, n, None), repetitions),
        measured("loss, used", False, name, lambda d, n: world.loss(d, n, None), few, ONLINE),
        measured("loss, Welch alone: not used", False, name, world.welch, few, ONLINE),
    ]


def rows(repetitions: int, workers: int, kinds: str) -> Iterator[Row]:
    """Yield all rows."""
    with ProcessPoolExecutor(workers) as processes:
        jobs = [processes.submit(of_rate, p, repetitions) for p in RATES if kinds != "approximate"]
        jobs += [processes.submit(of_world, name, repetitions, kinds) for name in DRAWN]
        for job in jobs:
            yield from job.result()


def main() -> None:
    """Print the table, and how many exact bounds hold in too few samples."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--repetitions", type=int, default=2000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--kinds", choices=("exact", "approximate", "both"), default="both")
    asked = parser.parse_args()
    found = sorted(
        rows(asked.repetitions, asked.workers, asked.kinds), key=lambda row: (not row.exact, row.bound)
    )
    print(f"| bound | world | {' | '.join(f'n = {n}' for n in EPISODES)} |")
    print(f"|---|---|{'---|' * len(EPISODES)}")
    print(*(row.line() for row in found), sep="\n")
    ends = [end for row in found if row.exact for pair in row.held for end in pair]
    error = 2 * sqrt(GOAL * (1 - GOAL) / (asked.repetitions // 2))
    missed = sum(end < GOAL - error for end in ends)
    print(f"\n{missed} of {len(ends)} shares of exact bounds are below {GOAL:.0%} by more than chance.")


if __name__ == "__main__":
    main()
