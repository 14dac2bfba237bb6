"""The expression that a clamp limits; a correction there stays within the limits.

In `max(-top, min(top, gain * error))`, this is `gain * error`. A helper that limits its argument, as in
`mass * push(error)`, is followed: its argument is limited.
"""

from __future__ import annotations

import ast
from collections.abc import Collection

from pytest_tarl.patching.clamps import CLAMPS, OPPOSITE
from pytest_tarl.patching.document import Document, Function, argument_names, called


def within_limits(source: Document, node: ast.expr, known: Collection[str]) -> ast.expr | None:
    """Return the limited expression, or None if nothing is limited or it is not clear what.

    `known` contains the code of named constants, which count as limits and as factors.
    """
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return within_limits(source, node.operand, known)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        sides = [node.left, node.right] if isinstance(node.op, ast.Mult) else [node.left]
        found = [within_limits(source, each, known) for each in sides]
        fixed = [_constant(source, each, known) for each in (node.left, node.right)]
        return next(filter(None, found), None) if any(fixed) else None
    if not isinstance(node, ast.Call) or node.keywords:
        return None
    value = _clamped(source, node, known)
    if value is not None:
        return within_limits(source, value, known) or value
    return _passed(source, node, known)


def _clamped(source: Document, call: ast.Call, known: Collection[str]) -> ast.expr | None:
    """Return the argument of a clamp that is not a limit."""
    name = called(call)
    if name in CLAMPS and len(call.args) == 3:
        possible = call.args[:1]
    elif name in OPPOSITE and len(call.args) == 2:
        possible = call.args
    else:
        return None
    values = [each for each in possible if not _constant(source, each, known)]
    return values[0] if len(values) == 1 else None


def _passed(source: Document, call: ast.Call, known: Collection[str]) -> ast.expr | None:
    """Return the only argument of a call whose function just limits a value computed from it."""
    functions = [
        one for one in ast.walk(source.tree) if isinstance(one, Function) and one.name == called(call)
    ]
    if len(functions) != 1 or len(call.args) != 1 or isinstance(call.args[0], ast.Starred):
        return None
    names = argument_names(functions[0])
    returns = [one for one in ast.walk(functions[0]) if isinstance(one, ast.Return)]
    if len(names) != 1 or len(returns) != 1 or not isinstance(returns[0].value, ast.Call):
        return None
    value = _clamped(source, returns[0].value, known)
    # helpers of helpers are not followed, because a helper that calls itself would be followed endlessly
    if value is None or not any(isinstance(one, ast.Name) and one.id in names for one in ast.walk(value)):
        return None
    return None if _constant(source, call.args[0], known) else call.args[0]


def _constant(source: Document, node: ast.expr, known: Collection[str]) -> bool:
    """Return whether an expression is a literal or a named constant, perhaps with a sign."""
    if isinstance(node, ast.UnaryOp):
        return _constant(source, node.operand, known)
    return isinstance(node, ast.Constant) or source.source(node) in known
