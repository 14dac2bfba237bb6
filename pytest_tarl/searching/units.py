"""Units of a search: one operand (a use of a constant), or all uses of one constant within a statement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, log

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.charts import Chart
from pytest_tarl.patching.mutate import Mutation, stepped
from pytest_tarl.searching.search import Mutate, operand_effect
from tarl_lint.model import Operand

NEAR = (2.2, 0.4)  # the first factors to try on every unit


@dataclass(frozen=True, slots=True)
class Unit:
    """Operands that are mutated together: `max(-LIMIT, min(LIMIT, x))` has one limit, used twice.

    With a chart (another scale for the constant), a factor is a step on that scale.
    """

    operands: tuple[Operand, ...]
    chart: Chart | None = None

    def mutations(self, mutate: Mutate, factor: float) -> tuple[Mutation, ...]:
        """Return a mutation for every operand that the factor changes."""
        tried = (stepped(operand, factor, self.chart, mutate) for operand in self.operands)
        return tuple(mutation for mutation in tried if mutation is not None)


def units(operands: Sequence[Operand]) -> tuple[Unit, ...]:
    """Group the uses of one constant and pairs of literal limits such as -2 and 2; keep the order."""
    groups: list[list[Operand]] = []
    for operand in operands:
        alike = next((group for group in groups if _alike(group[0], operand)), None)
        if alike is None:
            groups.append([operand])
        else:
            alike.append(operand)
    return tuple(Unit(tuple(group)) for group in groups)


def charted(plain: Sequence[Unit], charts: Mapping[Operand, Chart]) -> tuple[Unit, ...]:
    """Add a unit on its chart after each unit whose constant has one; for a constant of 0, instead replace the unit."""
    found: list[Unit] = []
    for unit in plain:
        chart = charts.get(unit.operands[0])
        if chart is None or unit.operands[0].value != 0:
            found.append(unit)
        if chart is not None and all(charts.get(one) == chart for one in unit.operands):
            found.append(Unit(unit.operands, chart))
    return tuple(found)


def change_size(unit: Unit, factor: float) -> float:
    """Return the size of a change: |log(new value / old value)|, infinite for a changed sign or an old value of 0."""
    value = unit.operands[0].value
    by: float | None = factor
    if unit.chart is not None and value is not None:
        by = unit.chart.factor(float(value), factor)
    return abs(log(by)) if by is not None and by > 0.0 and value != 0 else inf


def whole_constants(apart: Sequence[Unit]) -> tuple[Unit, ...]:
    """Unite the uses of a named constant in all statements of a file; keep the order."""
    groups: list[list[Unit]] = []
    for unit in apart:
        alike = next((group for group in groups if _same_constant(group[0], unit)), None)
        if alike is None:
            groups.append([unit])
        else:
            alike.append(unit)
    return tuple(
        Unit(tuple(dict.fromkeys(one for unit in group for one in unit.operands)), group[0].chart)
        for group in groups
    )


def _same_constant(unit: Unit, other: Unit) -> bool:
    one, two = unit.operands[0], other.operands[0]
    if one.literal or two.literal or one.definition is None or isinstance(one.value, bool):
        return False
    here = one.span.path == two.span.path and unit.chart == other.chart
    return here and one.code == two.code and one.definition == two.definition


def best_effects(
    gained: Iterable[tuple[Unit, Mapping[float, float]]], mutate: Mutate
) -> dict[str, list[OperandEffect]]:
    """Return for each site id the gain of each operand at its best factor; on ties, the factor tried first wins."""
    best: dict[Operand, OperandEffect] = {}
    for unit, gains in gained:
        tried = [factor for factor in gains if unit.mutations(mutate, factor)]
        factor = max(tried, key=lambda one: (gains[one], -one), default=1.0)
        for mutation in unit.mutations(mutate, factor):
            if mutation.operand not in best or gains[factor] > best[mutation.operand].effect:
                best[mutation.operand] = operand_effect(mutation, gains[factor])
    found: dict[str, list[OperandEffect]] = {}
    for operand, effect in best.items():
        found.setdefault(str(operand.site), []).append(effect)
    return found


def _alike(one: Operand, other: Operand) -> bool:
    if one.site != other.site or isinstance(one.value, bool):
        return False
    if one.literal or other.literal:
        opposite = one.value is not None and other.value is not None and one.value == -other.value != 0
        return one.literal and other.literal and opposite
    return one.code == other.code and one.definition == other.definition
