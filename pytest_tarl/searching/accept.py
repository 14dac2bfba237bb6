"""Does a repair hold? Sequentially, on seeds that nothing was chosen by.

The lower confidence bound of (repaired - off-line) must not lie below the margin -δ, in the drifted and in the nominal
world, and the pass rate must not fall by more than five points. Where a drift shows in some missions only, a few lucky
ones prove nothing: nothing is accepted before so many episodes that it would have shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil, log, log1p, sqrt, tan
from statistics import NormalDist, fmean, variance

import numpy as np

from pytest_tarl.model import Reason

LOOKS = (8, 12, 17, 24, 32, 40)  # episodes after which the bound is looked at
PASS_RATE_LOSS = 0.05
FEW_DEGREES = 20  # of freedom


@dataclass(frozen=True, slots=True)
class Outcome:
    """One episode: total reward, and whether the test passed."""

    total: float
    passed: bool


@dataclass(frozen=True, slots=True)
class Reference:
    """The off-line world that a repair is held against; `margin` is δ, a reward per episode."""

    totals: Sequence[float]
    pass_rate: float
    margin: float

    @property
    def mean(self) -> float:
        """Return the off-line average total reward."""
        return fmean(self.totals)


@dataclass(frozen=True, slots=True)
class World:
    """Where a candidate is run, by seed; `exposure` is the share of missions in which there is something to see.

    In the drifted world those that lose without repair, in the nominal one those in which the guard holds.
    """

    run: Callable[[int], Outcome]
    exposure: float = 1.0


@dataclass(frozen=True, slots=True)
class Acceptance:
    """How the test ended; `drifted` and `nominal` are the episodes it took, nominal empty when none were needed."""

    accepted: bool
    reason: Reason
    drifted: tuple[Outcome, ...]
    nominal: tuple[Outcome, ...]


def accept(
    drifted: World,
    nominal: World | None,
    seeds: Sequence[int],
    reference: Reference,
    alpha: float,
) -> Acceptance:
    """Test one candidate; `nominal` is None where the repair cannot make a difference in the nominal world.

    `seeds` must be fresh, `LOOKS[-1]` of them; `alpha` is the whole risk, shared over looks and worlds.
    """
    worlds = [drifted] if nominal is None else [drifted, nominal]
    runs: list[tuple[Outcome, ...]] = []
    reasons: tuple[Reason, ...] = ("gain too small", "nominal gets worse")
    for world, reason in zip(worlds, reasons, strict=False):
        first = episodes_to_see(world.exposure, alpha)
        held, outcomes = _holds(map(world.run, seeds), reference, alpha / len(LOOKS), first)
        runs.append(outcomes)
        if not held:
            return Acceptance(False, reason, runs[0], runs[1] if len(runs) > 1 else ())
    return Acceptance(True, "", runs[0], runs[1] if len(runs) > 1 else ())


def episodes_to_see(exposure: float, alpha: float) -> int:
    """Return after how many episodes one that matters has been seen but for the risk α; at most all there are."""
    if exposure >= 1.0:
        return LOOKS[0]
    return min(LOOKS[-1], ceil(log(alpha) / log1p(-exposure))) if exposure > 0.0 else LOOKS[-1]


def _holds(
    outcomes: Iterator[Outcome], reference: Reference, risk: float, first: int
) -> tuple[bool, tuple[Outcome, ...]]:
    """Look again and again until it is clear; nothing is accepted before `first` episodes."""
    seen: list[Outcome] = []
    for look in LOOKS:
        while len(seen) < look:
            seen.append(next(outcomes))
        totals = [outcome.total for outcome in seen]
        lower, upper = interval(totals, reference.totals, risk)
        failed = sum(not outcome.passed for outcome in seen)
        allowed = 1 - reference.pass_rate + PASS_RATE_LOSS
        if upper < -reference.margin or failed > allowed * LOOKS[-1]:
            return False, tuple(seen)
        if look >= first and lower >= -reference.margin and failed <= allowed * look:
            return True, tuple(seen)
    return False, tuple(seen)


def interval(repaired: Sequence[float], offline: Sequence[float], risk: float) -> tuple[float, float]:
    """Return the one-sided lower and upper bounds of mean(repaired) - mean(offline), each at `risk` (Welch)."""
    parts = [_spread(repaired), _spread(offline)]
    spread = sqrt(sum(parts))
    freedom = [
        part**2 / max(len(group) - 1, 1) for part, group in zip(parts, (repaired, offline), strict=True)
    ]
    degrees = sum(parts) ** 2 / sum(freedom) if sum(freedom) > 0 else 1e9
    reach = student_quantile(1 - risk, degrees) * spread
    difference = fmean(repaired) - fmean(offline)
    return difference - reach, difference + reach


def student_quantile(probability: float, degrees: float) -> float:
    """Return a quantile of Student's t above the median; for many degrees by Abramowitz & Stegun 26.7.5.

    For few, where that expansion is far too low, by adding up the density over θ = atan(t / √degrees): cosᵈ⁻¹θ.
    """
    if degrees < FEW_DEGREES:
        angle = np.linspace(0.0, np.pi / 2, 20_001)
        density = np.cos(angle) ** (degrees - 1)
        below = np.append(0.0, np.cumsum(density[1:] + density[:-1]))
        reached = float(np.interp((2 * probability - 1) * below[-1], below, angle))
        return tan(reached) * sqrt(degrees)
    z = NormalDist().inv_cdf(probability)
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / degrees + second / degrees**2 + third / degrees**3


def _spread(values: Sequence[float]) -> float:
    return variance(values) / len(values) if len(values) > 1 else 0.0
