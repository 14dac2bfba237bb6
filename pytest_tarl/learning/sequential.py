"""Group-sequential testing: a comparison may stop at planned looks, which share its risk (alpha spending).

After a share t of the episodes, α·t² of the risk α has been spent (Lan & DeMets 1983). The shares of all looks sum to
α, so the risk of a false alarm is at most α (union bound), although the looks depend on each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pytest_tarl.learning.drift import Difference, judged
from pytest_tarl.model import Region

FEWEST = 10  # minimum number of episodes at the first look


@dataclass(frozen=True)
class Look:
    """A planned look: the number of episodes after which it takes place, and its share of α."""

    episodes: int
    share: float


def planned(episodes: int, looks: int) -> tuple[Look, ...]:
    """Return at most `looks` looks: each has twice as many episodes as the previous one, and the last has all."""
    return spending([episodes >> k for k in reversed(range(looks)) if episodes >> k >= min(FEWEST, episodes)])


def spending(ends: Sequence[int]) -> tuple[Look, ...]:
    """Return looks after these ascending numbers of episodes; together they spend all of α."""
    spent = [(end / ends[-1]) ** 2 for end in ends]
    shares = [after - before for before, after in zip([0.0, *spent], spent, strict=False)]
    return tuple(Look(end, share) for end, share in zip(ends, shares, strict=True))


def certain(difference: Difference) -> bool:
    """Return whether the verdict is final: both the decrease and the region are significant."""
    region = difference.region
    return difference.verdict.result == "degraded" and bool(region.cells or region.novel)


def concluded(seen: Sequence[tuple[Look, Difference]], alpha: float) -> Difference:
    """Return the result of the last look, with p-values and interval adjusted for all looks.

    An adjusted p-value is the smallest p / share over the looks. The interval uses the risk of the last look, so it is
    valid no matter at which look the comparison stops.
    """
    last = seen[-1][1]
    p_drift, p_loss, p_failures = (
        min(1.0, *(getattr(found.verdict, name) / look.share for look, found in seen))
        for name in ("p_drift", "p_loss", "p_failures")
    )
    interval = last.verdict.interval and last.verdict.interval._replace(confidence=1 - 2 * alpha)
    adjusted = replace(last.verdict, p_drift=p_drift, p_loss=p_loss, p_failures=p_failures, interval=interval)
    verdict = judged(adjusted, alpha)
    return replace(
        last, verdict=verdict, region=last.region if verdict.result != "no difference" else Region()
    )
