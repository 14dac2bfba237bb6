"""Decide which of two repairs a maintainer would prefer to write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from enum import IntEnum
from math import inf, isclose, isfinite, pi

from pytest_tarl.model import Guard
from pytest_tarl.patching.charts import step_to
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tarl_lint.name_words import words

INSTEAD = 3  # maximum number of other constants to which an offset is moved
UNTRIED = 2  # maximum number of untried named constants to try in place of a changed literal
# values of the acceleration of gravity in programs, in m/s²
GRAVITY = (9.8, 9.81, 9.82, 9.807, 9.8066, 9.80665)
# words that occur in the names of constants that are 1 or -1
SIGNS = ("sign", "polarity", "direction", "invert", "inverted")
ROUNDED = 6e-4  # relative error of 3.14 as a value of π, rounded up


class Oddness(IntEnum):
    """How unusual a change looks to a maintainer; the least unusual kind comes first.

    `NAMED` scales a named constant and `INNER` a literal. `VARIABLE` scales a name whose value may come from several
    constants, so the repair writes a new factor next to the name. `OFFSET` adds a number, flips a sign, or scales a
    constant that is only a sign. `NATURE` changes a constant of nature.
    """

    NAMED = 0
    INNER = 1
    VARIABLE = 2
    OFFSET = 3
    NATURE = 4


def oddness(mutations: Iterable[Mutation]) -> Oddness:
    """Return the highest oddness among the mutations."""
    return max((_of(one) for one in mutations), default=Oddness.NAMED)


def plainer(
    odd: Oddness,
    gains: Mapping[Unit, Mapping[float, float]],
    units: Sequence[Unit],
    promising: float,
    beside: Unit | None = None,
) -> list[Unit]:
    """Return the units whose change would be less unusual than a change of oddness `odd`, best gain first.

    Units that gain at least `promising` come first. Untried units follow, the least unusual first. Among equally
    unusual constants, those in the statement of `beside` come first: in a product, a named constant has the same effect
    as the literal next to it. Constants in the next lines follow: a lower threshold has the same effect as a larger
    value that is compared with it. If `odd` is less than `VARIABLE`, at most `UNTRIED` untried units are returned.
    """
    read = [unit for unit in units if kind(unit) < odd]
    gaining = [unit for unit in read if unit in gains and max(gains[unit].values()) >= promising]
    untried = [unit for unit in read if unit not in gains]
    others = sorted(untried, key=lambda unit: (kind(unit), _lines_after(unit, beside)))
    if odd < Oddness.VARIABLE:
        others = others[:UNTRIED]
    return [*sorted(gaining, key=lambda unit: -max(gains[unit].values())), *others]


def instead_of_offset(found: Candidate, units: Sequence[Unit]) -> list[tuple[Unit, float]]:
    """If a candidate adds an offset, return other constants of the same statement, moved by that offset instead.

    Each is moved up and down: `x + 0.2 > LIMIT` means the same as `x > LIMIT - 0.2`. Named zeros come first, because an
    offset belongs there if there is such a constant. Other named constants follow.
    """
    if len(found.mutations) != 1:
        return []
    (mutation,) = found.mutations
    operand, value = mutation.operand, mutation.value
    if operand.value != 0 or mutation.form is not None or isinstance(value, bool):
        return []
    others = [one for one in units if one.chart is None or one.operands[0].value == 0]
    others = [
        one for one in others if one.operands[0].site == operand.site and _may_take(one.operands[0], operand)
    ]
    others.sort(key=lambda one: (one.operands[0].literal, one.operands[0].value != 0))
    return [
        (unit, step)
        for unit in others[:INSTEAD]
        for by in (value, -value)
        if (step := _moved_by(unit, float(by))) is not None
    ]


def _may_take(other: Operand, operand: Operand) -> bool:
    """Return whether the offset of `operand` may be added to `other` instead."""
    numeric = other.value is not None and not isinstance(other.value, bool)
    return other != operand and numeric and not (other.literal and other.value == 0)


def _moved_by(unit: Unit, offset: float) -> float | None:
    """Return the step that adds an offset to a unit's constant, or None for a sign change."""
    value = float(unit.operands[0].value or 0.0)
    if value == 0.0:
        return step_to(offset if unit.chart is None else offset / unit.chart.size)
    factor = (value + offset) / value
    return factor if factor > 0.0 else None


def named(units: Iterable[Unit]) -> list[Unit]:
    """Return the units that are named constants."""
    return [unit for unit in units if kind(unit) is Oddness.NAMED]


def writing(operand: Operand) -> Oddness:
    """Return how unusual it is to write a change of an operand. The least odd operands are tried first.

    In a product, scaling a named constant and scaling a literal have the same effect; a maintainer changes the named
    one. A literal zero is more often a bound or a start value than a tuned number.
    """
    zero = operand.value == 0 and not isinstance(operand.value, bool)
    if of_nature(operand):
        return Oddness.NATURE
    if not operand.literal:
        return Oddness.INNER if zero else _scaled(operand)
    return Oddness.OFFSET if zero else Oddness.INNER


def edges(guard: Guard) -> tuple[str, ...]:
    """Return the sensors that have a threshold in this guard. At a threshold, the repair switches on abruptly."""
    return tuple(
        one.sensor.name
        for one in guard.conjuncts
        if one.sensor.numeric and (isfinite(one.low) or isfinite(one.high))
    )


def of_nature(operand: Operand) -> bool:
    """Return whether an operand is a constant of nature: the acceleration of gravity, π or 2 π."""
    if operand.value is None or isinstance(operand.value, bool):
        return False
    value = abs(operand.value)
    return value in GRAVITY or any(isclose(value, times * pi, rel_tol=ROUNDED) for times in (1, 2))


def is_sign(operand: Operand) -> bool:
    """Return whether an operand is a named sign: `SIGN_LEFT = -1` may become 1, but not -1.4."""
    if operand.literal or isinstance(operand.value, bool) or operand.value not in (1, -1):
        return False
    return not words(operand.code).isdisjoint(SIGNS)


def kind(unit: Unit) -> Oddness:
    """Return how unusual it is to scale the constant of a unit."""
    operand = unit.operands[0]
    if operand.value == 0 and not isinstance(operand.value, bool):
        return Oddness.OFFSET
    return _scaled(operand)


def _lines_after(unit: Unit, beside: Unit | None) -> float:
    """Count the lines from `beside` down to the unit; -1 in the same statement, infinite if the unit is above."""
    if beside is None:
        return inf
    one, other = unit.operands[0], beside.operands[0]
    if one.site == other.site:
        return -1
    down = one.span.line - other.span.line
    return down if one.span.path == other.span.path and down >= 0 else inf


def _scaled(operand: Operand) -> Oddness:
    """Return how unusual it is to scale an operand that is not 0."""
    if of_nature(operand):
        return Oddness.NATURE
    if is_sign(operand):
        return Oddness.OFFSET
    if operand.literal:
        return Oddness.INNER
    return Oddness.VARIABLE if operand.definition is None and not operand.setting else Oddness.NAMED


def _of(mutation: Mutation) -> Oddness:
    operand, value = mutation.operand, mutation.value
    if isinstance(operand.value, bool) or isinstance(value, bool):
        return _scaled(operand)
    factor = value / operand.value if operand.literal and operand.value else value
    if factor == -1.0 and is_sign(operand):
        return Oddness.NAMED
    if operand.value == 0 or (factor < 0 and not of_nature(operand)):
        return Oddness.OFFSET
    return _scaled(operand)
