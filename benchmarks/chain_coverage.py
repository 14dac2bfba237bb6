"""Measure how often a chain of tests on shared seeds wrongly confirms a drift that meets the guarantee.

    python benchmarks/chain_coverage.py [--chains 4000]

A chain tests eight drifts in turn. The first five fail too often. The last three fail in 5 of 100 episodes, which the
guarantee just allows; confirming one of them is an error, which a chain may make with a probability of at most RISK.
For a share of the seeds, the random outcome is the same under all drifts; for the others, outcomes are independent. The
table also gives the mean number of episodes per chain, and how many of the five failing drifts it confirms on average.
All figures are repeated for chains whose tests do not use which seeds failed before.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import Count
from pytest_tarl.stressing.guarantee import Guarantee, Outcome
from pytest_tarl.stressing.rate_tests import LOOKS, RateTests

RATES = (0.6, 0.4, 0.3, 0.25, 0.2, 0.05, 0.05, 0.05)
WRONG = 5  # index of the first drift at which the guarantee holds
RISK = 0.05
SHARES = (0.0, 0.5, 1.0)
GIVEN = Guarantee(0.95, 0.5, (1.0,) * 100, 1.0)


@dataclass
class Episodes:
    """A stand-in for the evaluator; `failed`, of shape (drifts, seeds), says which episodes fail."""

    failed: Any
    guarantee: Guarantee = GIVEN
    spent: int = 0

    def ordered(self, _: str, point: Point, rows: Sequence[int]) -> dict[int, Outcome]:
        """Return a drift's outcomes on the seeds `rows`."""
        self.spent += len(rows)
        return {row: Outcome(not self.failed[round(point["drift"]), row], 1.0) for row in rows}

    def count(self, _: str, count: Count) -> None:
        """Do nothing with the count."""


def chain(draws: np.random.Generator, alike: float, *, shared: bool = True) -> tuple[bool, int, int]:
    """Run a chain; return whether it errs, its episodes, and the number of failing drifts that it confirms."""
    size = LOOKS[-1]
    own, common = draws.random((len(RATES), size)), draws.random(size)
    luck = np.where(draws.random(size) < alike, common, own)
    episodes: Any = Episodes(luck < np.array(RATES)[:, None])
    tests = RateTests(episodes, "fresh", RISK)
    for drift in range(len(RATES)):
        if not shared:
            tests.ran, tests.failed = set(), set()
        if not tests.confirm({"drift": float(drift)}):
            return drift > WRONG, episodes.spent, min(drift, WRONG)
    return True, episodes.spent, WRONG


def main() -> None:
    """Print a line for each share of seeds whose outcome is the same under all drifts."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--chains", type=int, default=4000)
    number = parser.parse_args().chains
    print(
        "| same outcome | wrong | allowed | episodes, confirmed | without shared seeds |\n|---|---|---|---|---|"
    )
    for alike in SHARES:
        cells = []
        for shared in (True, False):
            found = [chain(np.random.default_rng([1, seed]), alike, shared=shared) for seed in range(number)]
            wrong, spent, right = np.mean(np.array(found, float), axis=0)
            cells += [f"{wrong:.2%} | {RISK:.0%}"] * shared + [f"{spent:.0f}, {right:.2f} of {WRONG}"]
        print(f"| {alike:.0%} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
