"""Looks: when a comparison may end early, at a risk that is shared over all of them.

Of the risk α, α·t² is spent by the time that a share t of the episodes has run (Lan & DeMets 1983). The looks add up to
α whatever the dependence between them, so an early end costs no false alarms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pytest_tarl.learning.drift import Difference, judged
from pytest_tarl.model import Region

FEWEST = 10  # episodes before the first look


@dataclass(frozen=True)
class Look:
    """After how many episodes to look, and the share of α that may be spent there."""

    episodes: int
    share: float


def planned(episodes: int, looks: int) -> tuple[Look, ...]:
    """Return at most `looks` looks, each at twice the episodes of the one before, the last at all of them."""
    ends = [episodes >> k for k in reversed(range(looks)) if episodes >> k >= min(FEWEST, episodes)]
    spent = [(end / episodes) ** 2 for end in ends]
    shares = [after - before for before, after in zip([0.0, *spent], spent, strict=False)]
    return tuple(Look(end, share) for end, share in zip(ends, shares, strict=True))


def certain(difference: Difference) -> bool:
    """Tell whether more episodes would change nothing: the loss is there, and so is where it comes from."""
    region = difference.region
    return difference.verdict.result == "degraded" and bool(region.cells or region.novel)


def concluded(seen: Sequence[tuple[Look, Difference]], alpha: float) -> Difference:
    """Return what the last look found, its figures those of the whole sequence.

    Of p-values that is the least of p / share. The interval is the last look's, at the risk left to that look, so it
    holds whenever the run ended.
    """
    last = seen[-1][1]
    p_drift, p_loss = (
        min(1.0, *(getattr(found.verdict, name) / look.share for look, found in seen))
        for name in ("p_drift", "p_loss")
    )
    interval = last.verdict.interval and last.verdict.interval._replace(confidence=1 - 2 * alpha)
    verdict = judged(replace(last.verdict, p_drift=p_drift, p_loss=p_loss, interval=interval), alpha)
    return replace(
        last, verdict=verdict, region=last.region if verdict.result != "no difference" else Region()
    )
