"""Group-sequential testing: looks at which a comparison may end early, with shared risk (alpha spending).

Of the risk α, α·t² is spent once a share t of the episodes has run (Lan & DeMets 1983). The looks add up to
α under any dependence between them, so ending early does not increase false alarms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pytest_tarl.learning.drift import Difference, judged
from pytest_tarl.model import Region

FEWEST = 10  # episodes before the first look


@dataclass(frozen=True)
class Look:
    """A planned look: its number of episodes, and the share of α spent there."""

    episodes: int
    share: float


def planned(episodes: int, looks: int) -> tuple[Look, ...]:
    """Return at most `looks` looks; each has twice the episodes of the previous one, and the last one has all."""
    return spending([episodes >> k for k in reversed(range(looks)) if episodes >> k >= min(FEWEST, episodes)])


def spending(ends: Sequence[int]) -> tuple[Look, ...]:
    """Return looks after these increasing numbers of episodes, which together spend all of α."""
    spent = [(end / ends[-1]) ** 2 for end in ends]
    shares = [after - before for before, after in zip([0.0, *spent], spent, strict=False)]
    return tuple(Look(end, share) for end, share in zip(ends, shares, strict=True))


def certain(difference: Difference) -> bool:
    """Return whether the verdict is final: both the loss and its region are significant."""
    region = difference.region
    return difference.verdict.result == "degraded" and bool(region.cells or region.novel)


def concluded(seen: Sequence[tuple[Look, Difference]], alpha: float) -> Difference:
    """Return the result of the last look, with p-values and intervals adjusted for the whole sequence.

    The adjusted p-value is the least p / share. The interval of the last look is computed at that look's risk, so it
    holds at whatever look the run ended.
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
