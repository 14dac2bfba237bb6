"""Steps to try on a plateau: failing missions earn the same, so no change gains reward, or a large change gains most.

Without a gradient, the search has to hit the range of good values by trial. Most constants are wrong by a factor of
less than two, and good ranges are often narrow. Therefore, finer and finer steps between the first two steps (2.2 and
0.4) are tried on named constants. After some of them, larger steps are tried on all constants whose smaller step did
not reduce the reward.

If a large change gains most, it is often only a way around the problem. Before it is combined with other changes, the
inward steps (those between the first two) are tried on the constants that matter, within a fixed number of episodes. If
a smaller change then gains much, it is refined first.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Key
from pytest_tarl.searching.plainness import Oddness, kind, named
from pytest_tarl.searching.units import Unit, change_size

Step = tuple[float, float | None]
INWARD = None  # a placeholder for steps between the first two steps (2.2 and 0.4)
# pairs (step, smaller step that must not have reduced the reward), in the order in which they are tried; neighbouring
# inward steps differ by at most 10 %
STEPS: tuple[Step, ...] = (
    *((1.5, INWARD), (0.65, INWARD), (5.0, 2.2), (0.15, 0.4), (1.22, INWARD), (0.82, INWARD)),
    *((1.35, INWARD), (0.74, INWARD), (1.1, INWARD), (0.91, INWARD), (10.0, 5.0), (0.05, 0.15)),
    *((1.75, INWARD), (0.55, INWARD), (1.16, INWARD), (0.86, INWARD), (1.285, INWARD), (0.78, INWARD)),
    *((1.42, INWARD), (0.7, INWARD), (1.62, INWARD), (0.6, INWARD), (1.05, INWARD), (0.95, INWARD)),
)
# if there are many literals, this number of steps (up to 1.1 and 0.91) is tried before the literals
FINE_UNTIL = 10
NEARBY = 2.5  # a change is large if it multiplies or divides a constant by more than this factor
AROUND = 40  # maximum number of episodes for inward steps around large changes that gain
AT_LEAST = 2  # minimum number of inward steps around large changes that gain


def best_is_far(gains: Gains, guard: Guard) -> bool:
    """Return whether, under a guard, the change that clearly gains most reward is a large one.

    An offset counts as large if it changes the constant by a large factor.
    """
    near, far = [0.0], [0.0]
    for unit, by_factor in gains.under(guard).items():
        for factor, gain in by_factor.items():
            (near if change_size(unit, factor) <= log(NEARBY) + 1e-9 else far).append(gain)
    return max(far) > max(near) + gains.slack


def nearby(tried: Sequence[Key], gains: Gains, least: float) -> list[Key]:
    """Among `tried`, return the units and guards whose best factor is not large and gains at least `least`.

    Return an empty list if the change that gains most is not a large one.
    """
    best = {key: max(gains.of(*key).items(), key=lambda one: one[1]) for key in tried}
    near = [key for key, (factor, _) in best.items() if change_size(key[0], factor) <= log(NEARBY) + 1e-9]
    if max(tried, key=gains.most, default=None) in near:
        return []
    return [key for key in near if best[key][1] >= least]


def inward(units: Sequence[Unit], gains: Gains) -> tuple[list[Unit], list[float]]:
    """Return the constants that matter, except zeros, and the inward steps to try on them.

    If any named constant matters, unnamed constants are left out.
    """
    matter = [
        unit for unit in units if unit.chart is None and gains.matters(unit) and kind(unit) < Oddness.OFFSET
    ]
    matter = named(matter) or matter
    steps = [step for step, before in STEPS if before is INWARD]
    return matter, steps[: max(AT_LEAST, AROUND // max(len(matter), 1))]


def among(before: float | None, units: Sequence[Unit], gains: Gains, guard: Guard) -> list[Unit]:
    """Return the units to try with a step: those that the smaller step `before` did not harm."""
    if before is INWARD:
        return [unit for unit in named(units) if unit.chart is None and gains.matters(unit)]
    leading = gains.leading(before, guard, units, -gains.slack)
    return [unit for unit in leading if kind(unit) < Oddness.OFFSET]
