"""Find limits that cross, as in `max(1.2, min(1.0, x))`, which is 1.2 for every x.

If a changed limit is beyond the opposite limit, the clamp always returns the same value. The node then ignores the
value that it computes, and may command a value that the opposite limit forbids. Nobody would merge such a change, even
if all missions pass.
"""

from __future__ import annotations

import ast

from pytest_tarl.patching.clamps import CLAMPS, OPPOSITE
from pytest_tarl.patching.document import Document, called


def crosses(source: Document, node: ast.expr, value: float) -> bool:
    """Return whether a limit with this value would be beyond the opposite literal limit."""
    node = _with_sign(source, node)
    call = source.parents.get(node)
    if not isinstance(call, ast.Call) or node not in call.args or isinstance(value, bool):
        return False
    name = called(call)
    if name in CLAMPS and len(call.args) == 3:
        place = call.args.index(node)
        other = _number(call.args[3 - place]) if place else None
        return other is not None and (value > other if place == 1 else value < other)
    if name not in OPPOSITE or len(call.args) != 2:
        return False
    others = [_limit(one, OPPOSITE[name]) for one in (*call.args, source.parents.get(call))]
    return any(one is not None and (value > one if name == "max" else value < one) for one in others)


def _limit(node: ast.AST | None, name: str) -> float | None:
    """Return the literal argument of a two-argument `min` or `max`; None for any other expression."""
    if not isinstance(node, ast.Call) or called(node) != name or len(node.args) != 2:
        return None
    return next((found for one in node.args if (found := _number(one)) is not None), None)


def _number(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
    except ValueError:
        return None
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def _with_sign(source: Document, node: ast.expr) -> ast.expr:
    """Return the literal with its sign: in the syntax tree, `-2` is an operation on the literal `2`."""
    parent = source.parents.get(node)
    return parent if isinstance(parent, ast.UnaryOp) else node
