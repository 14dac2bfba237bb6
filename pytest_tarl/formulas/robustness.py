"""Compute the robustness of a formula over an episode, and when it becomes impossible to satisfy.

Robustness is the margin by which a formula holds; it is negative if the formula is violated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.grammar import atoms
from pytest_tarl.formulas.parsing import Formula
from pytest_tarl.formulas.semantics import (
    BOOLEAN,
    CONNECTIVES,
    FUTURE,
    Always,
    Atoms,
    Conjunction,
    Disjunction,
    Eventually,
    Implies,
    Neg,
    Skeleton,
    TimedAlways,
    TimedEventually,
    bounds,
    operands,
)
from pytest_tarl.formulas.signals import Samples, cut

Values = Mapping[int, Samples]  # samples of each atom of a formula, by id(node)
# assumed size of an atom's unknown future values; larger than any real value
FARTHEST = 1e308


@dataclass(frozen=True)
class Course:
    """A formula and the values of its atoms (comparisons) over an episode."""

    formula: Formula
    values: Values

    def until(self, end: int) -> Course:
        """Return the course up to a given time."""
        return replace(self, values={key: cut(samples, end) for key, samples in self.values.items()})


def course(formula: Formula, signals: Mapping[str, Samples]) -> Course:
    """Compute the atoms. Raise SettingsError if one has no value, for example after a division by zero."""
    visitor = Atoms(signals)
    try:
        return Course(formula, {id(atom): visitor.visit(atom) for atom in atoms(formula.tree)})
    except Exception as problem:  # rtamt raises plain Exceptions
        raise SettingsError(
            f"The formula {formula.text!r} has no value: {str(problem).rstrip('.')}. Correct the formula, or the "
            "values of its signals."
        ) from problem


def robustness(course: Course, end: int) -> float:
    """Return a formula's robustness on the course up to a given time; positive if it is satisfied."""
    samples = Skeleton(course.until(end).values, end).visit(course.formula.tree)
    return float(samples[0][1])


def running(course: Course, ends: Sequence[int]) -> list[float]:
    """Return the robustness on the course up to each of these times (ascending)."""
    return _running(course, course.formula.tree, ends)


def lost_at(course: Course, instants: Sequence[int]) -> int | None:
    """Return the first time after which no future can satisfy the formula, or None if one still can.

    The result is never too early. It can be too late if atoms depend on each other, because each atom's future is
    assumed to be independent.
    """
    low, high = 0, len(instants)
    while low < high:
        middle = (low + high) // 2
        if _hopeless(course, instants[middle]):
            high = middle
        else:
            low = middle + 1
    return instants[low] if low < len(instants) else None


def _hopeless(course: Course, now: int) -> bool:
    known = course.until(now)
    values: dict[int, Samples] = {}
    tree = _hopeful(course.formula.tree, 1, known.values, now, values)
    found = Skeleton(values, math.inf).visit(tree)
    return bool(found[0][1] <= 0)


def _hopeful(node: Any, sign: int, known: Values, now: int, values: dict[int, Samples]) -> Any:
    """Return a copy of a tree in which atoms have their most favourable values after `now`."""
    copy = _copied(node)
    if not isinstance(node, CONNECTIVES):
        values[id(copy)] = [*known[id(node)], [now + 1, sign * FARTHEST]]
        return copy
    signs = (
        (-sign, sign) if isinstance(node, Implies) else (-sign,) if isinstance(node, Neg) else (sign, sign)
    )
    copy.children = [
        _hopeful(child, one, known, now, values) for child, one in zip(operands(node), signs, strict=False)
    ]
    return copy


def _copied(node: Any) -> Any:
    """Copy a node without its children, so that an atom that occurs twice can have two values."""
    copied = object.__new__(type(node))
    copied.__dict__.update(node.__dict__)
    return copied


def _running(course: Course, node: Any, ends: Sequence[int]) -> list[float]:
    """Return a node's robustness at each time.

    `always` and `eventually` are computed incrementally if their operands do not look ahead; all other nodes are
    computed anew.
    """
    if isinstance(node, BOOLEAN):
        parts = [_running(course, child, ends) for child in operands(node)]
        return [_joined(node, values) for values in zip(*parts, strict=True)]
    folded = isinstance(node, (Always, Eventually, TimedAlways, TimedEventually))
    if folded and not _looks_ahead(operands(node)[0]):
        samples = Skeleton(course.values, ends[-1] if ends else 0).visit(operands(node)[0])
        timed = isinstance(node, (TimedAlways, TimedEventually))
        begin, end = bounds(node) if timed else (0, math.inf)
        least = isinstance(node, (Always, TimedAlways))
        return _extremes(samples, ends, (begin, end), min if least else max)
    part = replace(course, formula=replace(course.formula, tree=node))
    return [robustness(part, end) for end in ends]


def _extremes(
    samples: Samples,
    ends: Sequence[int],
    window: tuple[float, float],
    extreme: Callable[[float, float], float],
) -> list[float]:
    """Return the largest (or smallest) value up to each time in `ends`, in a window from the start."""
    found: list[float] = []
    place, begun, seen = 0, False, samples[0][1]

    def advance(until: float) -> Iterator[float]:
        nonlocal place
        while place + 1 < len(samples) and samples[place + 1][0] <= until:
            place += 1
            yield samples[place][1]

    for now in ends:
        if not begun:
            for value in advance(min(now, window[0])):
                seen = value
            begun = now >= window[0]
        if begun:
            for value in advance(min(now, window[1])):
                seen = extreme(seen, value)
        found.append(float(seen))
    return found


def _joined(node: Any, values: tuple[float, ...]) -> float:
    if isinstance(node, Neg):
        return -values[0]
    if isinstance(node, Implies):
        return max(-values[0], values[1])
    if isinstance(node, Conjunction):
        return min(values)
    if isinstance(node, Disjunction):
        return max(values)
    raise TypeError(f"{node!r} is not a connective.")


def _looks_ahead(node: Any) -> bool:
    return isinstance(node, FUTURE) or (
        isinstance(node, CONNECTIVES) and any(_looks_ahead(child) for child in operands(node))
    )
