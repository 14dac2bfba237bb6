"""Decide whether a passing repair should be compared with milder alternatives, and which constants to try for them.

For example, a rope camera with wet brake pads overshoots its mark. A very low speed avoids this, and so does a wrong
value for gravity. A maintainer would correct the friction of the pads instead. Then the mission goes as designed.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import Oddness, named, oddness
from pytest_tarl.searching.search import Candidate, Goal, Trials
from pytest_tarl.searching.units import NEAR, Unit
from tarl_lint.model import SiteId

COARSE = (1.5, 0.65)
FINE = (*COARSE, 1.22, 0.82, 1.35, 0.73)
# alternatives are tried if the lengths of the repaired and the designed mission differ by more than this factor
LONGER = 1.3


def another_way(candidate: Candidate, trials: Trials, goal: Goal) -> bool:
    """Return whether a candidate changes a constant of nature, or makes missions much longer or shorter."""
    if oddness(candidate.mutations) is Oddness.NATURE:
        return True
    steps = trials.steps(candidate, goal.pairs)
    if not goal.steps or not steps:
        return False
    ratio = fmean(steps) / goal.steps
    return max(ratio, 1.0 / ratio) > LONGER


def gentler(
    found: Unit, units: Sequence[Unit], gains: Gains, guard: Guard, promising: float
) -> list[tuple[Unit, Sequence[float]]]:
    """Return the named constants to try instead of `found`, each with its factors, best statement first.

    The factors are closer to 1 if any constant of the same statement gained at least `promising`. Constants that were
    increased and decreased without any effect are left out.
    """
    tried = gains.under(guard)
    at_site: dict[SiteId, float] = {}
    for unit, by_factor in tried.items():
        site = unit.operands[0].site
        at_site[site] = max(at_site.get(site, 0.0), *by_factor.values())
    moved = {unit for unit in tried if gains.matters(unit) or not set(NEAR) <= tried[unit].keys()}
    others = [
        unit
        for unit in named(units)
        if unit.operands != found.operands and (unit in moved or unit not in tried)
    ]
    worth = {unit: at_site.get(unit.operands[0].site, 0.0) for unit in others}
    others.sort(key=lambda unit: -worth[unit])
    return [(unit, FINE if worth[unit] >= promising else COARSE) for unit in others]
