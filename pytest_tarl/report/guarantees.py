"""What is stated of the next episodes, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pytest_tarl.model import Comparison, Guarantee

SCOPE = "over the worlds that this test draws"
WORLDS = {"offline": "designed", "repaired": "repaired", "nominal_repaired": "designed, repaired"}


def sentences(stated: Guarantee) -> Iterator[str]:
    """Yield a sentence a bound; one alone where episodes do not vary, since they tell of no other world."""
    sure = f"with {100 * stated.success.confidence:.5g} % confidence"
    every = "every one" if stated.passed == stated.episodes else f"{stated.passed}"
    if not stated.varied:
        yield (
            f"one world was tested: all {stated.episodes} episodes are the same ({every} succeeded), so nothing is "
            "stated of others. Draw what may vary from tarl.rng."
        )
        return
    yield (
        f"{stated.passed} of {stated.episodes} missions succeed: {sure} at least {percent(stated.success.low)} do, "
        f"{SCOPE}"
    )
    how = (
        "totals within the declared range" if stated.mean.exact else "approximate: no total_range is declared"
    )
    yield f"{figure(stated.average)} reward a mission: {sure} at least {figure(stated.mean.low)} on average ({how})"
    most = percent(1 - stated.share)
    if stated.quantile is not None:
        yield f"{most} of the missions earn at least {figure(stated.quantile)}, {sure}"
    elif stated.needed:
        yield (
            f"what {most} of the missions earn at least takes {stated.needed} episodes, "
            f"{stated.needed - stated.episodes} more than were run"
        )
    yield "each of these holds by itself"


def brief(stated: Guarantee) -> Iterator[str]:
    """Yield the bounds in one line."""
    if not stated.varied:
        yield f"one world was tested, {stated.episodes} times"
        return
    sure = f"{100 * stated.success.confidence:.5g} % confidence"
    mean = "at least" if stated.mean.exact else "approximately at least"
    yield (
        f"success at least {percent(stated.success.low)}, mean reward {mean} {figure(stated.mean.low)} ({sure} each, "
        f"{stated.episodes} episodes)"
    )


def worlds(comparison: Comparison) -> Iterator[tuple[str, Guarantee]]:
    """Yield the worlds of which something is stated, by the names that a report has for them."""
    for world, name in WORLDS.items():
        if world in comparison.stated:
            yield name, comparison.stated[world]


def percent(share: float) -> str:
    """Write a share rounded down to a tenth of a per cent, so that a bound stays one."""
    return f"{math.floor(1000 * share + 1e-9) / 10:.1f} %".replace(".0 %", " %")


def figure(value: float) -> str:
    """Write a reward."""
    return f"{value:.4g}" if math.isfinite(value) else "nothing"
