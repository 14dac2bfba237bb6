"""Describe the decomposition of a fleet's variance in lines of text."""

from __future__ import annotations

from collections.abc import Iterator
from math import isinf, isnan

from pytest_tarl.fleet.components import Component
from pytest_tarl.fleet.decomposition import Decomposition

NAMES = {"mission": "within a robot"}
EXTREMES = 2  # maximum number of levels to name for each factor


def lines(parts: Decomposition) -> Iterator[str]:
    """Yield one line per component: its share, its interval and its most extreme levels."""
    total = parts.total
    yield f"Variance of a mission's reward, {total:.4g}, by source ({100 * parts.confidence:g} % intervals)"
    for one, levels in zip(parts.components, (*parts.levels, (), ()), strict=True):
        named = lowest(one, levels)
        yield f"  {name(one, parts):<16}{_amount(one, total)}{f', lowest: {named}' if named else ''}"


def name(one: Component, parts: Decomposition) -> str:
    """Return the name of a component for the report."""
    return f"season ({parts.season})" if one.name == "season" else NAMES.get(one.name, one.name)


def problem(one: Component) -> str:
    """Return why a component or its interval is unknown, or an empty string."""
    if one.levels == 1:
        return "only one"
    if isnan(one.variance):
        return "cannot be told apart from the others"
    return "too few robots for an interval" if isinf(one.high) else ""


def _amount(one: Component, total: float) -> str:
    why = problem(one)
    if one.levels == 1 or isnan(one.variance):
        return why
    share = 100 * max(0.0, one.variance) / total if total > 0 else 0.0
    return f"{share:5.1f} %  {max(0.0, one.variance):.3g} ({why or f'{one.low:.3g} to {one.high:.3g}'})"


def lowest(one: Component, levels: tuple[str, ...]) -> str:
    """Name the levels with the lowest effects, unless the variance is 0."""
    if problem(one) or not one.effects or not one.low > 0:
        return ""
    order = sorted(range(len(levels)), key=lambda n: (one.effects[n], levels[n]))[:EXTREMES]
    named = [level or f"no {one.name}" for level in levels]
    return ", ".join(f"{named[n]} {one.effects[n]:+.3g}" for n in order if one.effects[n] < 0)
