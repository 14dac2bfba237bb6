"""Expressions composed of literals alone: `math.pi / 6`, `math.radians(20.0)`."""

from __future__ import annotations

from typing import Final

from tarl_lint.ir import nodes as ir

CONSTANTS: Final = frozenset(["pi", "tau", "e"])  # names in math and numpy


def computed(expr: ir.Expr) -> ir.Pos | None:
    """Return the position of a number computed from literals; None for other expressions.

    If the number is computed from a single literal, this is the position of the literal. Otherwise, it is the
    position of the whole expression.
    """
    if not isinstance(expr, (ir.Operation, ir.Call)) or not of_literals(expr):
        return None
    found = numbers(expr)
    return found[0].pos if len(found) == 1 else expr.pos


def of_literals(expr: ir.Expr) -> bool:
    """Return whether the operands and arguments in an expression are all literals or mathematical constants."""
    if isinstance(expr, ir.Const):
        return isinstance(expr.value, (int, float, str))
    if isinstance(expr, ir.Attribute):
        return expr.name in CONSTANTS and isinstance(expr.base, ir.Name)
    if isinstance(expr, ir.Operation):
        return expr.operator != "text" and all(map(of_literals, expr.parts))
    if isinstance(expr, ir.SequenceDisplay):
        return all(map(of_literals, expr.items))
    if isinstance(expr, ir.Call):
        return bool(expr.arguments) and not expr.keywords and all(map(of_literals, expr.arguments))
    return False


def numbers(expr: ir.Expr) -> list[ir.Const]:
    """Return the numbers in an expression, in source order."""
    if isinstance(expr, ir.Const):
        return [expr] if isinstance(expr.value, (int, float)) and not isinstance(expr.value, bool) else []
    if isinstance(expr, ir.Operation):
        return [each for part in expr.parts for each in numbers(part)]
    if isinstance(expr, ir.SequenceDisplay):
        return [each for item in expr.items for each in numbers(item)]
    if isinstance(expr, ir.Call):
        return [each for argument in expr.arguments for each in numbers(argument)]
    return []
