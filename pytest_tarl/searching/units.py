"""Units of a search: one use of a constant, or all its uses within a statement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, log

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.charts import Chart
from pytest_tarl.patching.mutate import Mutation, stepped
from pytest_tarl.searching.search import Mutate, operand_effect
from tarl_lint.model import Operand

NEAR = (2.2, 0.4)  # the first factors to try on every unit
# if one use gains at least this share of what all uses together gain, it gets credit for the whole gain
ENOUGH = 0.9
# names of the code that runs once, before any message: module level ("") and constructors
SET_UP = ("", "__init__")

Scope = Callable[[Operand], str]


def everywhere(_: Operand) -> str:
    """Return "": a name means the same constant in the whole file."""
    return ""


@dataclass(frozen=True, slots=True)
class Unit:
    """Operands that are mutated together, such as both uses of the limit in `max(-LIMIT, min(LIMIT, x))`.

    If the unit has a chart (another scale for the constant), its factors are steps on that scale.
    """

    operands: tuple[Operand, ...]
    chart: Chart | None = None

    def mutations(self, mutate: Mutate, factor: float) -> tuple[Mutation, ...]:
        """Return a mutation for every operand that the factor changes."""
        tried = (stepped(operand, factor, self.chart, mutate) for operand in self.operands)
        return tuple(mutation for mutation in tried if mutation is not None)


def units(operands: Sequence[Operand]) -> tuple[Unit, ...]:
    """Group operands of one statement into units: uses of one constant, or two limits such as -2 and 2."""
    groups: list[list[Operand]] = []
    for operand in operands:
        alike = next((group for group in groups if _alike(group[0], operand)), None)
        if alike is None:
            groups.append([operand])
        else:
            alike.append(operand)
    return tuple(Unit(tuple(group)) for group in groups)


def charted(plain: Sequence[Unit], charts: Mapping[Operand, Chart]) -> tuple[Unit, ...]:
    """After each unit that has a chart, add a unit that moves on the chart. For a constant of 0, replace the unit."""
    found: list[Unit] = []
    for unit in plain:
        chart = charts.get(unit.operands[0])
        if chart is None or unit.operands[0].value != 0:
            found.append(unit)
        if chart is not None and all(charts.get(one) == chart for one in unit.operands):
            found.append(Unit(unit.operands, chart))
    return tuple(found)


def change_size(unit: Unit, factor: float) -> float:
    """Return |log(new value / old value)|; infinite for a changed sign or an old value of 0."""
    value = unit.operands[0].value
    by: float | None = factor
    if unit.chart is not None and value is not None:
        by = unit.chart.factor(float(value), factor)
    return abs(log(by)) if by is not None and by > 0.0 and value != 0 else inf


def whole_constants(apart: Sequence[Unit], scope: Scope = everywhere) -> tuple[Unit, ...]:
    """Make one unit of all uses of a named constant in a file; keep the order.

    `scope` returns the part of the file in which the name of an operand means the same constant.
    """
    groups: list[list[Unit]] = []
    for unit in apart:
        alike = next((group for group in groups if _same_constant(group[0], unit, scope)), None)
        if alike is None:
            groups.append([unit])
        else:
            alike.append(unit)
    return tuple(
        Unit(tuple(dict.fromkeys(one for unit in group for one in unit.operands)), group[0].chart)
        for group in groups
    )


def uses_apart(
    plain: Sequence[Unit], others: Sequence[Unit], scope: Scope = everywhere
) -> tuple[tuple[Unit, ...], dict[Unit, tuple[Unit, ...]]]:
    """Make one unit of all uses of each constant in `plain`. Return all units, and the uses that each unit replaces.

    If several statements use a constant, a maintainer would change it everywhere. Uses in `others` are not searched by
    themselves, but they change together with those in `plain`. The unit takes the place of its first use.
    """
    united: list[Unit] = []
    parts: dict[Unit, tuple[Unit, ...]] = {}
    for whole in whole_constants((*plain, *others), scope):
        mine = {*whole.operands}
        uses = [unit for unit in plain if unit.chart == whole.chart and mine.issuperset(unit.operands)]
        if uses and whole.operands == uses[0].operands:
            united.append(uses[0])
        elif uses:
            united.append(whole)
            parts[whole] = tuple(uses)
    return tuple(united), parts


def _same_constant(unit: Unit, other: Unit, scope: Scope) -> bool:
    one, two = unit.operands[0], other.operands[0]
    if one.literal or two.literal or one.definition is None or isinstance(one.value, bool):
        return False
    here = one.span.path == two.span.path and unit.chart == other.chart
    return here and one.code == two.code and one.definition == two.definition and scope(one) == scope(two)


def runs_once(unit: Unit) -> bool:
    """Return whether all operands of a unit run once, at module level or in a constructor."""
    return all(map(sets_up, unit.operands))


def sets_up(operand: Operand) -> bool:
    """Return whether an operand is at module level or in a constructor."""
    return operand.site.qualname.rpartition(".")[2] in SET_UP


def best_effects(
    gained: Iterable[tuple[Unit, Mapping[float, float]]], mutate: Mutate
) -> dict[str, list[OperandEffect]]:
    """For each site id, return the gain of each operand with its best factor.

    All uses of a constant together may gain more than the uses that were tried alone. Then the untried uses may bring
    the difference, so each tried use gets only its own gain. On ties, the smaller factor wins.
    """
    gained = list(gained)
    best: dict[Operand, OperandEffect] = {}
    for unit, gains in gained:
        tried = [factor for factor in gains if unit.mutations(mutate, factor)]
        factor = max(tried, key=lambda one: (gains[one], -one), default=1.0)
        for mutation in unit.mutations(mutate, factor):
            alone = _alone(mutation.operand, unit, factor, gained)
            gain = gains[factor] if alone is None else alone
            if mutation.operand not in best or gain > best[mutation.operand].effect:
                best[mutation.operand] = operand_effect(mutation, gain)
    found: dict[str, list[OperandEffect]] = {}
    for operand, effect in best.items():
        found.setdefault(str(operand.site), []).append(effect)
    return found


def _alone(
    operand: Operand, unit: Unit, factor: float, gained: Sequence[tuple[Unit, Mapping[float, float]]]
) -> float | None:
    """Return an operand's own gain if it is small and another operand may bring the unit's gain, else None."""
    if len(unit.operands) < 2:
        return None
    alone: dict[Operand, float] = {}
    whole = 0.0
    for one, gains in gained:
        if one.chart == unit.chart and factor in gains:
            if one == unit:
                whole = max(whole, gains[factor])
            elif {*one.operands} < {*unit.operands}:
                alone |= dict.fromkeys(one.operands, gains[factor])
    small = {one for one, gain in alone.items() if gain < ENOUGH * whole}
    return alone[operand] if operand in small and len(small) < len({*unit.operands}) else None


def _alike(one: Operand, other: Operand) -> bool:
    if one.site != other.site or isinstance(one.value, bool):
        return False
    if one.literal or other.literal:
        opposite = one.value is not None and other.value is not None and one.value == -other.value != 0
        return one.literal and other.literal and opposite
    return one.code == other.code and one.definition == other.definition
