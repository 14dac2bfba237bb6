"""Does a repair hold? Sequentially, on seeds that nothing was chosen by.

The lower confidence bound of (repaired - off-line) must lie above the margin -δ, in the drifted and in the nominal
world, and the pass rate must not fall by more than five points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import sqrt
from statistics import NormalDist, fmean, variance

from pytest_tarl.model import Reason

LOOKS = (8, 12, 17, 24, 32, 40)  # episodes after which the bound is looked at
PASS_RATE_LOSS = 0.05


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
class Acceptance:
    """How the test ended; `drifted` and `nominal` are the episodes it took, nominal empty when none were needed."""

    accepted: bool
    reason: Reason
    drifted: tuple[Outcome, ...]
    nominal: tuple[Outcome, ...]


def accept(
    drifted: Callable[[int], Outcome],
    nominal: Callable[[int], Outcome] | None,
    seeds: Sequence[int],
    reference: Reference,
    alpha: float,
) -> Acceptance:
    """Test one candidate; `nominal` is None where the repair cannot make a difference in the nominal world.

    `seeds` must be fresh, `LOOKS[-1]` of them; `alpha` is the whole risk, shared over looks and worlds.
    """
    worlds = [drifted] if nominal is None else [drifted, nominal]
    risk = alpha / len(LOOKS)
    runs: list[tuple[Outcome, ...]] = []
    reasons: tuple[Reason, ...] = ("gain too small", "nominal gets worse")
    for world, reason in zip(worlds, reasons, strict=False):
        held, outcomes = _holds(map(world, seeds), reference, risk)
        runs.append(outcomes)
        if not held:
            return Acceptance(False, reason, runs[0], runs[1] if len(runs) > 1 else ())
    return Acceptance(True, "", runs[0], runs[1] if len(runs) > 1 else ())


def _holds(
    outcomes: Iterator[Outcome], reference: Reference, risk: float
) -> tuple[bool, tuple[Outcome, ...]]:
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
        if lower > -reference.margin and failed <= allowed * look:
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
    """Return the quantile of Student's t by its expansion in 1/degrees (Abramowitz & Stegun 26.7.5)."""
    z = NormalDist().inv_cdf(probability)
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / degrees + second / degrees**2 + third / degrees**3


def _spread(values: Sequence[float]) -> float:
    return variance(values) / len(values) if len(values) > 1 else 0.0
