"""Evaluate formulas in dense time with rtamt, corrected where rtamt differs from its documentation.

Time is counted in whole nanoseconds. Signals, and therefore all subformulas, are constant between changes. Before the
episode, a subformula has its first value, and after the known part its last one. Robustness is therefore finite
whenever the signals are.

The dense time of rtamt 0.4 is corrected as follows:

- The left side of `until` and `since` need not hold at the moment when the right side holds. (This is rtamt's own rule
  in discrete time.)
- A comparison of equal values is slightly positive if it holds, and slightly negative otherwise (`TRUTH`).
- An empty window does not give infinity.
- Units of bounds are converted correctly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pytest_tarl.formulas import quietly  # noqa: F401

# isort: split

from rtamt.semantics.stl.dense_time.offline import ast_visitor as dense
from rtamt.semantics.stl.dense_time.offline import intersection
from rtamt.syntax.node.ltl.always import Always
from rtamt.syntax.node.ltl.conjunction import Conjunction
from rtamt.syntax.node.ltl.disjunction import Disjunction
from rtamt.syntax.node.ltl.eventually import Eventually
from rtamt.syntax.node.ltl.historically import Historically
from rtamt.syntax.node.ltl.implies import Implies
from rtamt.syntax.node.ltl.neg import Neg
from rtamt.syntax.node.ltl.once import Once
from rtamt.syntax.node.ltl.since import Since
from rtamt.syntax.node.ltl.until import Until
from rtamt.syntax.node.stl.timed_always import TimedAlways
from rtamt.syntax.node.stl.timed_eventually import TimedEventually
from rtamt.syntax.node.stl.timed_historically import TimedHistorically
from rtamt.syntax.node.stl.timed_once import TimedOnce
from rtamt.syntax.node.stl.timed_since import TimedSince
from rtamt.syntax.node.stl.timed_until import TimedUntil

from pytest_tarl.formulas.signals import Samples

__all__ = [
    "BOOLEAN", "CONNECTIVES", "FUTURE", "PAST", "TIMED", "TRUTH", "Always", "Atoms", "Conjunction", "Disjunction",
    "Eventually", "Implies", "Neg", "Skeleton", "TimedAlways", "TimedEventually", "bounds", "operands",
]  # fmt: skip

TRUTH = 1e-300  # absolute robustness of a comparison of equal values, so that robustness is never 0
UNITS = {"": 10**9, "s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}

BOOLEAN = (Neg, Conjunction, Disjunction, Implies)
FUTURE = (Always, Eventually, Until, TimedAlways, TimedEventually, TimedUntil)
PAST = (Historically, Once, Since, TimedHistorically, TimedOnce, TimedSince)
TIMED = (TimedAlways, TimedEventually, TimedUntil, TimedHistorically, TimedOnce, TimedSince)
CONNECTIVES = BOOLEAN + FUTURE + PAST
STRICT = ("<", ">", "!=")  # comparisons that are false for equal values


def operands(node: Any) -> tuple[Any, ...]:
    """Return a node's children; for some nodes, rtamt lists them twice."""
    binary = isinstance(node, (Conjunction, Disjunction, Implies, Until, TimedUntil, Since, TimedSince))
    return tuple(node.children[: 2 if binary else 1])


def bounds(node: Any) -> tuple[int, int]:
    """Return the window of a timed operator in nanoseconds."""
    return round(node.begin * UNITS[node.begin_unit]), round(node.end * UNITS[node.end_unit])


class Atoms(dense.StlDenseTimeOfflineAstVisitor):  # type: ignore[misc]
    """Evaluate atoms: comparisons, and numbers used as formulas."""

    def __init__(self, signals: Mapping[str, Samples]) -> None:
        self._signals = signals

    def visitVariable(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return the samples of a signal."""
        return self._signals[node.var]

    def visitConstant(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return a constant as one sample."""
        return [[0, node.val]]

    def visitPredicate(self, node: Any, *args: Any, **kwargs: Any) -> Samples:  # noqa: N802
        """Return the margin of a comparison, with ±TRUTH instead of 0. Raise ArithmeticError for NaN."""
        equal = -TRUTH if str(node.operator) in STRICT else TRUTH
        found: Samples = super().visitPredicate(node, *args, **kwargs)
        if any(math.isnan(value) for _, value in found):
            raise ArithmeticError("infinity minus infinity is not a number")
        return [[time, value or equal] for time, value in found]


class Skeleton(dense.StlDenseTimeOfflineAstVisitor):  # type: ignore[misc]
    """Evaluate the connectives of a formula.

    The samples of its atoms are given, by id(node), up to time `end` (ns).
    """

    def __init__(self, atoms: Mapping[int, Samples], end: float) -> None:
        self._atoms = atoms
        self._end = end

    def visit(self, node: Any, *args: Any, **kwargs: Any) -> Samples:
        """Return a node's value over time, cut off at `end`."""
        known = self._atoms.get(id(node))
        return known if known is not None else self._clipped(super().visit(node, *args, **kwargs))

    def time_unit_transformer(self, node: Any) -> tuple[int, int]:
        """Return the window of a timed operator; called by rtamt."""
        return bounds(node)

    def visitUntil(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return the maximum over all times t of min(right at t, minimum of left before t)."""
        return _until(*self._both(node))

    def visitSince(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return `until`, mirrored in time."""
        return _since(*self._both(node))

    def visitTimedUntil(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return `until` with a window.

        The left side holds up to the start of the window; from there on, `until` holds within the window.
        """
        (left, right), (begin, end) = self._both(node), bounds(node)
        within = dense.and_operation(
            dense.eventually_timed_operation(right, 0, end - begin), _until(left, right)
        )
        if not begin:
            return within  # type: ignore[no-any-return]
        held = dense.always_timed_operation(left, 0, begin - 1)
        return dense.and_operation(held, dense.eventually_timed_operation(within, begin, begin))  # type: ignore[no-any-return]

    def visitTimedSince(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return `until` with a window, mirrored in time."""
        (left, right), (begin, end) = self._both(node), bounds(node)
        within = dense.and_operation(_once(right, 0, end - begin), _since(left, right))
        if not begin:
            return within  # type: ignore[no-any-return]
        held = dense.historically_timed_operation(left, 0, begin - 1)
        return dense.and_operation(held, _once(self._clipped(within), begin, begin))  # type: ignore[no-any-return]

    def visitTimedOnce(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return the largest value in a past window."""
        return _once(self.visit(operands(node)[0]), *bounds(node))

    def visitTimedHistorically(self, node: Any, *_: Any, **__: Any) -> Samples:  # noqa: N802
        """Return the smallest value in a past window."""
        sample, (begin, end) = self.visit(operands(node)[0]), bounds(node)
        return _begun(dense.historically_timed_operation(sample, begin, end), sample)

    def _both(self, node: Any) -> tuple[Samples, Samples]:
        left, right = operands(node)
        return self.visit(left), self.visit(right)

    def _clipped(self, samples: Samples) -> Samples:
        last = len(samples)
        while last > 1 and samples[last - 1][0] > self._end:
            last -= 1
        return samples[:last]


def _until(left: Samples, right: Samples) -> Samples:
    pairs = intersection.intersection(left, right, intersection.split)[0]
    found: Samples = []
    following = -math.inf
    for time, (held, reached) in reversed(pairs):
        following = max(reached, min(held, following))
        found.append([time, following])
    return found[::-1]


def _since(left: Samples, right: Samples) -> Samples:
    pairs = intersection.intersection(left, right, intersection.split)[0]
    found: Samples = []
    before = -math.inf
    for time, (held, reached) in pairs:
        before = max(reached, min(held, before))
        found.append([time, before])
    return found


def _once(sample: Samples, begin: int, end: int) -> Samples:
    return _begun(dense.once_timed_operation(sample, begin, end), sample)


def _begun(samples: Samples, operand: Samples) -> Samples:
    """Use the operand's first value instead of rtamt's infinity in windows that end before the start."""
    return [[time, operand[0][1] if i == 0 else value] for i, (time, value) in enumerate(samples)]
