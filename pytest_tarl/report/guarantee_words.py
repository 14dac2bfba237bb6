"""Describe the bounds for future episodes in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pytest_tarl.model import Comparison, Guarantee

SCOPE = "over the worlds that this test samples"
WORLDS = {"offline": "designed", "repaired": "repaired", "nominal_repaired": "designed, repaired"}


def sentences(stated: Guarantee) -> Iterator[str]:
    """Yield one sentence per bound, or one sentence if all episodes were equal."""
    sure = f"with {100 * stated.success.confidence:.5g} % confidence"
    every = "every one" if stated.passed == stated.episodes else f"{stated.passed}"
    if not stated.varied:
        yield (
            f"only one world was tested: all {stated.episodes} episodes are equal ({every} succeeded), so there are "
            "no bounds for other worlds. Draw variable quantities from tarl.rng."
        )
        return
    yield (
        f"{stated.passed} of {stated.episodes} missions succeeded: success rate at least "
        f"{percent(stated.success.low)} {sure}, {SCOPE}"
    )
    how = (
        "totals within the declared range" if stated.mean.exact else "approximate: no total_range is declared"
    )
    yield f"mean reward {figure(stated.average)} per mission: at least {figure(stated.mean.low)} {sure} ({how})"
    most = percent(1 - stated.share)
    if stated.quantile is not None:
        yield f"{most} of the missions earn at least {figure(stated.quantile)}, {sure}"
    elif stated.needed:
        yield (
            f"stating a reward that {most} of the missions reach needs {stated.needed} episodes, "
            f"{stated.needed - stated.episodes} more than were run"
        )
    yield "each bound holds separately"


def brief(stated: Guarantee) -> Iterator[str]:
    """Return the bounds in one line."""
    if not stated.varied:
        yield f"only one world was tested, {stated.episodes} times"
        return
    sure = f"{100 * stated.success.confidence:.5g} % confidence"
    mean = "at least" if stated.mean.exact else "approximately at least"
    yield (
        f"success at least {percent(stated.success.low)}, mean reward {mean} {figure(stated.mean.low)} ({sure} each, "
        f"{stated.episodes} episodes)"
    )


def worlds(comparison: Comparison) -> Iterator[tuple[str, Guarantee]]:
    """Yield name (as displayed) and bounds of each world that has bounds."""
    for world, name in WORLDS.items():
        if world in comparison.stated:
            yield name, comparison.stated[world]


def percent(share: float) -> str:
    """Format a share, rounded down to 0.1 % so that it stays a lower bound."""
    return f"{math.floor(1000 * share + 1e-9) / 10:.1f} %".replace(".0 %", " %")


def figure(value: float) -> str:
    """Format a reward."""
    return f"{value:.4g}" if math.isfinite(value) else "nothing"
