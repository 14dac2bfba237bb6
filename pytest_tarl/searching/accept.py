"""Does a repair hold? Sequentially, on seeds that nothing was chosen by.

The lower confidence bound of (repaired - off-line) must not lie below the margin -δ, in the drifted and in the nominal
world, and the pass rate must not fall by more than five points. Where a drift shows in some missions only, a few lucky
ones prove nothing: nothing is accepted before so many episodes that it would have shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import ceil, log, log1p
from statistics import fmean

from pytest_tarl.formulas.judging import Judged
from pytest_tarl.learning.intervals import difference_bounds
from pytest_tarl.model import Reason

LOOKS = (8, 12, 17, 24, 32, 40)  # episodes after which the bound is looked at
# ... and the share of the risk at each look. They add up to more than one, since looks have episodes in common: the
# probability that any of them errs, integrated over the paths of the mean, stays below the risk (tested).
SHARES = (1 / 6, 1 / 6, 1 / 6, 0.2, 0.3, 0.39)
PASS_RATE_LOSS = 0.05


@dataclass(frozen=True, slots=True)
class Outcome:
    """One episode: total reward, whether the test passed, and what formulas came to."""

    total: float
    passed: bool
    judged: tuple[Judged, ...] = ()


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


def unforeseen(wanted: Sequence[object]) -> None:
    """Begin nothing ahead."""


@dataclass(frozen=True, slots=True)
class World:
    """Where a candidate is run, by seed; `exposure` is the share of missions in which there is something to see.

    In the drifted world those that lose without repair, in the nominal one those in which the guard holds. `foresee`
    is told the seeds that will be asked for, unless the test ends before.
    """

    run: Callable[[int], Outcome]
    exposure: float = 1.0
    foresee: Callable[[Sequence[int]], None] = unforeseen


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
        world.foresee(seeds)
        held, outcomes = _holds(map(world.run, seeds), reference, alpha, first)
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
    for look, share in zip(LOOKS, SHARES, strict=True):
        while len(seen) < look:
            seen.append(next(outcomes))
        totals = [outcome.total for outcome in seen]
        lower, upper = difference_bounds(totals, reference.totals, risk * share)
        failed = sum(not outcome.passed for outcome in seen)
        allowed = 1 - reference.pass_rate + PASS_RATE_LOSS
        if upper < -reference.margin or failed > allowed * LOOKS[-1]:
            return False, tuple(seen)
        if look >= first and lower >= -reference.margin and failed <= allowed * look:
            return True, tuple(seen)
    return False, tuple(seen)
