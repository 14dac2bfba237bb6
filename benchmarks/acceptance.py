"""Print how often the acceptance test accepts a repair, for given true rewards and failure rates.

    python benchmarks/acceptance.py [--runs 400]

The totals of missions are random numbers; nothing is simulated. A successful mission's total is normal with mean
`ratio` × 10. A failed mission earns -10, as little as the worst recorded mission. Designed missions earn 10 on average
and never fail. Part of the variance depends only on the seed, and is removed by comparing missions with equal seeds. A
repair is right if it loses less than 5 % of the designed reward on average, including failures, and fails in less than
5 % of its missions.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from pytest_tarl.searching.accept import SEEDS, Acceptance, Outcome, Reference, World, accept, risk_of

DESIGNED, WORST, MARGIN, ALPHA = 10.0, -10.0, 0.5, 0.05
RATIOS = (1.0, 0.99, 0.98, 0.97, 0.96, 0.95, 0.94, 0.92)
FAILING = (0.0, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.08, 0.12)


@dataclass(frozen=True)
class Drawn:
    """Random totals of missions, without a repair and with a repair on the same seeds."""

    seed: int
    spread: float
    shared: float  # share of the variance that depends only on the seed

    def designed(self) -> np.ndarray:
        """Return the unrepaired program's totals in the designed world."""
        return self._totals(0, DESIGNED)

    def repaired(self, ratio: float, failing: float) -> list[Outcome]:
        """Return the missions of a repair with this ratio and failure rate."""
        failed = np.random.default_rng([self.seed, 3]).random(SEEDS) < failing
        totals = np.where(failed, WORST, self._totals(1, DESIGNED * ratio))
        return [Outcome(float(total), not bad) for total, bad in zip(totals, failed, strict=True)]

    def _totals(self, stream: int, mean: float) -> np.ndarray:
        alike = np.random.default_rng([self.seed, 2]).normal(size=SEEDS)
        own = np.random.default_rng([self.seed, stream]).normal(size=SEEDS)
        totals: np.ndarray = mean + self.spread * (
            np.sqrt(self.shared) * alike + np.sqrt(1 - self.shared) * own
        )
        return totals


def tested(drawn: Drawn, ratio: float, failing: float) -> Acceptance:
    """Test a repair that changes nothing in the designed world."""
    designed, repaired = drawn.designed(), drawn.repaired(ratio, failing)
    recorded = np.random.default_rng([drawn.seed, 4]).normal(DESIGNED, drawn.spread, 200).tolist()
    return accept(
        World(lambda at: repaired[at]),
        None,
        World(lambda at: Outcome(float(designed[at]), passed=True)),
        range(SEEDS),
        Reference(recorded, 1.0, MARGIN, WORST),
        risk_of(ALPHA, 0),
    )


def row(name: str, ratio: float, failing: float, spread: float, shared: float, runs: int) -> str:
    """Return a line of the table."""
    found = [tested(Drawn(seed, spread, shared), ratio, failing) for seed in range(runs)]
    accepted = sum(one.accepted for one in found) / runs
    loses = DESIGNED - (1 - failing) * DESIGNED * ratio - failing * WORST
    right = loses < MARGIN and failing < 0.05
    episodes = sum(one.episodes for one in found) / runs
    return f"| {name} | {loses / DESIGNED:.1%} | {'right' if right else 'wrong'} | {accepted:.3f} | {episodes:.0f} |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--runs", type=int, default=400)
    runs = parser.parse_args().runs
    for spread, shared in ((0.1, 0.0), (1.0, 0.0), (1.0, 0.9)):
        print(f"\nspread {spread:g}, {shared:.0%} of it determined by the seed\n")
        print("| repair | true loss | right or wrong | accepted | episodes |\n|---|---|---|---|---|")
        for ratio in RATIOS:
            print(row(f"reward × {ratio:g}, never fails", ratio, 0.0, spread, shared, runs), flush=True)
        for failing in FAILING[1:]:
            print(row(f"reward × 1, fails {failing:.1%}", 1.0, failing, spread, shared, runs), flush=True)


if __name__ == "__main__":
    main()
