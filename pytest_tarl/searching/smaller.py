"""If a repair has to change a constant a lot, decide which other constants to change a little instead.

For example, the moisture probe of a dryer reads too low in frost, so the grain leaves the dryer too moist. Doubling the
limit of the hot air restores the reward, and so does lowering the moisture target by a sixth. A miscalibrated constant
is more often wrong by a sixth than by a factor of two. Besides, an unnecessarily large change is likely to do harm in
worlds that were not tested.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Part
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.units import Unit, change_size

STEPS = (0.82, 1.22)  # factors that are tried on each constant
BESIDE = (1.06, 0.94)  # if a step earns nearly enough, it is multiplied by these factors
LEAST = 1.9  # for changes by at least this factor, a smaller change of another constant is tried
LESS = 0.5  # a small change has at most this share of the size (see `change_size`) of the change found
ONWARD = (
    (0.74, 1.33),
    (0.62, 1.61),
    (0.5, 1.9),
)  # larger steps, in the direction in which a small step gained reward
LEADING = 3  # maximum number of constants that are tried with the steps ONWARD
TRACE = 0.005  # steps ONWARD follow a small step only if it gains at least this share of the wanted gain
OTHERS = 4  # maximum number of constants that are tried in small steps
EPISODES = 20  # number of episodes after which no further constant is tried
EARLY = 0.5  # after this share of the budget, a repair is no longer compared with smaller changes
LOST = 0.01  # a milder value of the same constant may lose at most this share of the wanted gain
INSIDE = 0.85  # a milder or smaller change is accepted only if a change by this share of its size passes, too
WORSE = 0.02  # maximum additional deviation of the smaller change's missions from the designed ones


def smaller(found: Unit, factor: float, units: Sequence[Unit], gains: Gains, guard: Guard) -> list[Part]:
    """Return small steps of other named constants: first the constants that gained most, then untried ones.

    At most `OTHERS` constants are returned. Constants that never changed a mission are left out, and so are steps
    larger than `LESS` times the change found.
    """
    most, tried = LESS * change_size(found, factor), gains.under(guard)
    others = [
        unit
        for unit in named(units)
        if unit.operands != found.operands
        and unit.chart is None
        and not isinstance(unit.operands[0].value, bool)
        and (unit not in tried or gains.matters(unit))
    ]
    others.sort(key=lambda unit: (unit not in tried, -max(tried.get(unit, {1.0: 0.0}).values())))
    return [
        (unit, step)
        for unit in others[:OTHERS]
        for step in STEPS
        if change_size(unit, step) <= most and step not in tried.get(unit, {})
    ]


def known_steps(found: Unit, units: Sequence[Unit], gains: Gains, guard: Guard) -> list[Part]:
    """Return the small steps of other named constants that were tried before."""
    others = [unit for unit in named(units) if unit.operands != found.operands and unit.chart is None]
    return [(unit, step) for unit in others for step in STEPS if step in gains.of(unit, guard)]


def onward(
    tried: Sequence[Part], found: Unit, factor: float, gains: Gains, guard: Guard, wanted: float
) -> list[Part]:
    """If small steps gained something, return larger steps in the same direction, best constant first.

    `tried` are the small steps that were tried, and `wanted` is the gain that a repair needs. Steps larger than `LESS`
    times the change found are left out.
    """
    gained = [(gains.of(unit, guard).get(step, 0.0), at) for at, (unit, step) in enumerate(tried)]
    best: dict[Unit, float] = {}
    for gain, at in sorted(gained, key=lambda one: -one[0]):
        if gain >= TRACE * wanted and len(best) < LEADING:
            best.setdefault(*tried[at])
    most = LESS * change_size(found, factor)
    steps = [(unit, up if step > 1.0 else down) for down, up in ONWARD for unit, step in best.items()]
    return [(unit, step) for unit, step in steps if change_size(unit, step) <= most]


def milder(unit: Unit, factor: float, gains: Mapping[float, float]) -> float | None:
    """Return the factor halfway to 1 on a log scale, or None if any factor between 1 and `factor` was tried.

    `gains` maps the factors tried on the unit to their gains. Booleans, constants of 0, and changes of sign have no
    such factor.
    """
    value = unit.operands[0].value
    if isinstance(value, bool) or value == 0 or unit.chart is not None or factor <= 0.0:
        return None
    low, high = sorted((1.0, factor))
    return None if any(low < one < high for one in gains) else round(sqrt(factor), 3)


def inside(factor: float) -> float:
    """Return a factor a little nearer to 1."""
    nearer: float = factor**INSIDE
    return round(nearer, 3)


def outside(factor: float) -> float:
    """Return the factor for which `inside` returns this one."""
    farther: float = factor ** (1.0 / INSIDE)
    return round(farther, 3)
