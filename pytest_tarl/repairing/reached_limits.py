"""Find limits that a drifted mission reaches but the designed mission does not: they may stop the drifted mission.

For example, a bottle capper gives up when its spindle has made two turns or has turned for a second. In the designed
world, no cap takes that much, so neither limit is ever reached. In the drifted world, the first limit is reached and,
once this limit is relaxed, the second one. Recorded missions show such limits in two ways. A comparison often gives a
result that is rare in the designed missions, or a value stays at a bound that it rarely reaches there.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.patching.clamps import BOUNDING
from pytest_tarl.patching.document import Document, called, document
from pytest_tarl.repairing.mission_pairs import Recorded, series
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching.limits_in_turn import Limit
from pytest_tarl.searching.units import NEAR
from pytest_tarl.symptoms.series import Pair, Series
from tarl_lint.model import Operand, Step

UP, DOWN = NEAR  # factors that are tried on a limit
# a value stays at a bound if at least the share `OFTEN` of its samples equals the bound. In the designed world, a bound
# or a result of a comparison counts as rare if its share of the samples is at most `RARELY`.
OFTEN, RARELY = 0.3, 0.05
SAME = 1e-9  # maximum relative difference between equal values

Bools = NDArray[np.bool_]
Ints = NDArray[np.intp]


@dataclass(frozen=True)
class _Reached:
    """A limit, the step at which it was reached, and whether the unchanged mission reached it."""

    limit: Limit
    before: bool
    step: int


def reached_limits(order: Order, pairs: Sequence[Recorded], before: Trace | None = None) -> list[Limit]:
    """Return the constants of limits that only a pair's second mission reaches, with factors.

    `before` is a drifted mission of the first pair's seed. Limits that it did not reach come first. Then limits are
    sorted by the time at which they are reached, because a later limit may be an effect of an earlier one.
    """
    found: list[_Reached] = []
    steps = {str(step.site): step for step in order.analysis.sites}
    for number, place in enumerate(plan(order.analysis).places):
        step = steps.get(place.id)
        for designed, drifted in pairs if step is not None else ():
            pair = Pair(series(designed, number), series(drifted, number))
            known = series(before, number) if before is not None else None
            if step is not None and pair.designed.values.size and pair.drifted.values.size:
                found += _reached(order, step, pair, known)
    found.sort(key=lambda one: (one.before, one.step))
    limits: dict[Operand, float] = {}
    for one in found:
        limits.setdefault(*one.limit)
    return list(limits.items())


def _reached(order: Order, step: Step, pair: Pair, before: Series | None) -> Iterator[_Reached]:
    """Yield the limits of one statement."""
    try:
        source = document(step.span.path, order.analysis.sources[step.span.path])
    except (RepairError, KeyError):
        return
    test = _test(source, step.span.line)
    for operand in order.analysis.operands(step.site):
        node = source.at(operand.span)
        if node is None or not operand.value or isinstance(operand.value, bool):
            continue
        if test is not None:
            side = _side(source, node, test)
            for outcome in (1.0, 0.0) if side else ():
                at = _newly(pair, outcome)
                if at is not None:
                    known = before is not None and bool(np.any(before.values == outcome))
                    larger = (side > 0.0) == (outcome == 0.0)
                    factor = UP if larger == (operand.value > 0.0) else DOWN
                    yield _Reached((operand, factor), known, at)
        elif _is_bound(source, node):
            bound = abs(float(operand.value))
            at = _stays(pair, bound)
            if at is not None:
                upper = float(np.abs(pair.drifted.values).max()) <= bound * (1.0 + SAME)
                known = before is not None and before.values.size > 0 and _at(before, bound).mean() >= OFTEN
                yield _Reached((operand, UP if upper else DOWN), bool(known), at)


def _newly(pair: Pair, outcome: float) -> int | None:
    """Return the step at which a comparison has given a result more often than in the designed mission, or None.

    The result must be rare in the designed mission. Only steps before the end of the drifted mission count.
    """
    together = pair.together()
    designed, drifted = (_times(one.values == outcome) for one in (together.designed, together.drifted))
    rare = float((pair.designed.values == outcome).mean()) <= RARELY
    return (
        int(together.drifted.step[drifted[designed.size]]) if rare and drifted.size > designed.size else None
    )


def _times(holds: Bools) -> Ints:
    """Return the indices at which `holds` becomes true."""
    return np.flatnonzero(holds & ~np.concatenate([[False], holds[:-1]]))


def _stays(pair: Pair, bound: float) -> int | None:
    """Return the first step at a bound if the value is often there, but rarely in the designed mission; else None."""
    at = _at(pair.drifted, bound)
    often = at.mean() >= OFTEN and _at(pair.designed, bound).mean() <= RARELY
    return int(pair.drifted.step[np.flatnonzero(at)[0]]) if often else None


def _at(values: Series, bound: float) -> Bools:
    return np.isclose(np.abs(values.values), bound, rtol=SAME, atol=0.0)


def _test(source: Document, line: int) -> ast.expr | None:
    """Return the condition of the statement at a line, or the comparison that the statement stores or returns."""
    for node in source.statements_at.get(line, ()):
        if isinstance(node, ast.If | ast.While):
            return node.test
        if isinstance(node, ast.Assign | ast.Return):
            return node.value if isinstance(node.value, ast.Compare | ast.BoolOp) else None
    return None


def _side(source: Document, node: ast.expr, test: ast.expr) -> float:
    """Return 1 if a larger constant makes a test true, -1 if it makes the test false, 0 if unknown.

    Only sums and products around the constant are followed. A constant that is subtracted has the opposite effect.
    """
    sign, inner = 1.0, node
    for around in source.ancestors(node):
        if isinstance(around, ast.Compare):
            if len(around.ops) != 1 or not isinstance(around.ops[0], ast.Lt | ast.LtE | ast.Gt | ast.GtE):
                return 0.0
            right = around.comparators[0] is inner
            sign *= 1.0 if right == isinstance(around.ops[0], ast.Lt | ast.LtE) else -1.0
        elif isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.USub | ast.Not):
            sign = -sign
        elif isinstance(around, ast.BinOp) and isinstance(around.op, ast.Sub | ast.Div):
            sign *= -1.0 if around.right is inner else 1.0
        elif not isinstance(around, ast.BoolOp | ast.BinOp):
            return 0.0
        if around is test:
            return sign
        inner = around
    return 0.0


def _is_bound(source: Document, node: ast.expr) -> bool:
    """Return whether a constant is passed, perhaps negated, to a function that limits a value."""
    around = source.parents.get(node)
    if isinstance(around, ast.UnaryOp):
        around = source.parents.get(around)
    return isinstance(around, ast.Call) and called(around) in BOUNDING
