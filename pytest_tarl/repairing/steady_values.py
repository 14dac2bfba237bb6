"""Expressions whose value does not vary, at which most structural changes have no effect of their own.

If a structural change without a sensor is applied to a constant, the result is another constant, and the search of
constants tries that anyway. A filter returns the same value again.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable

from pytest_tarl.patching.document import Document, called
from pytest_tarl.patching.templates import OF_SENSORS, Template
from tarl_lint.model import Operand

# functions that always return the same result for the same arguments
_PURE = ("abs", "bool", "float", "int", "max", "min", "pow", "radians", "degrees", "round", "sqrt")


def defined_once(operands: Iterable[Operand]) -> set[str]:
    """Return the codes of the operands that mean the same constant everywhere."""
    return {one.code for one in operands if one.definition is not None}


def is_constant(source: Document, node: ast.expr, constants: Collection[str]) -> bool:
    """Return whether an expression is computed from constants only, given by their code."""
    if isinstance(node, ast.Constant) or source.source(node) in constants:
        return True
    if isinstance(node, ast.BinOp):
        return all(is_constant(source, each, constants) for each in (node.left, node.right))
    if isinstance(node, ast.UnaryOp):
        return is_constant(source, node.operand, constants)
    pure = isinstance(node, ast.Call) and called(node) in _PURE and not node.keywords
    return pure and all(is_constant(source, each, constants) for each in node.args)  # type: ignore[attr-defined]


def adds_to(source: Document, node: ast.expr) -> bool:
    """Return whether a statement changes a variable by the value of an expression, as `total += step` does."""
    statement = source.statement(node)
    return isinstance(statement, ast.AugAssign) and statement.value is node


def has_effect(template: Template, constant: bool, steady: bool, added: bool) -> bool:
    """Return whether a template may have an effect that no other value of a constant has.

    `constant` says whether the expression is computed from constants. `steady` says whether its value did not vary
    within any recorded mission. `added` says whether the value is added to a variable. A template that ramps up from
    zero has an effect even on a constant command, at the start of a mission.
    """
    if template.on in OF_SENSORS or not template.parameters:
        return True
    if constant:
        return template.from_zero and not added
    return not (steady and template.from_first)
