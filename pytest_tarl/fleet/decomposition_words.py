"""The decomposition of a fleet's variance as lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from math import isinf, isnan

from pytest_tarl.fleet.components import Component
from pytest_tarl.fleet.decomposition import Decomposition

NAMES = {"mission": "within a robot"}
EXTREMES = 2  # levels named for each factor


def lines(parts: Decomposition) -> Iterator[str]:
    """Yield a line for each component: its share of the variance, its interval and its most extreme levels."""
    total = parts.total
    yield f"Variance of a mission's reward, {total:.4g}, by source ({100 * parts.confidence:g} % intervals)"
    names = (*parts.levels, (), ())
    for one, levels in zip(parts.components, names, strict=True):
        name = f"season ({parts.season})" if one.name == "season" else NAMES.get(one.name, one.name)
        yield f"  {name:<16}{_amount(one, total)}{_extremes(one, levels)}"


def _amount(one: Component, total: float) -> str:
    if one.levels == 1:
        return "only one"
    if isnan(one.variance):
        return "cannot be told apart from the others"
    share = 100 * max(0.0, one.variance) / total if total > 0 else 0.0
    interval = "too few robots for an interval" if isinf(one.high) else f"{one.low:.3g} to {one.high:.3g}"
    return f"{share:5.1f} %  {max(0.0, one.variance):.3g} ({interval})"


def _extremes(one: Component, levels: tuple[str, ...]) -> str:
    """Name the lowest levels if the variance is not 0."""
    if isnan(one.variance) or not one.effects or one.levels == 1 or not one.low > 0.0 or isinf(one.high):
        return ""
    order = sorted(range(len(levels)), key=lambda n: (one.effects[n], levels[n]))[:EXTREMES]
    return ", lowest: " + ", ".join(f"{levels[n]} {one.effects[n]:+.3g}" for n in order if one.effects[n] < 0)
