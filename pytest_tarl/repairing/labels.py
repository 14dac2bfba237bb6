"""Labels: constants that are not quantities. No search changes them.

A factor on a member of an enumeration raises an error. A factor on `self.done` in `if not self.done` changes nothing.
Some constants follow from notation and were not chosen by the author. The exponents in `(x**2 + y**2) ** 0.5` are
geometry, and so is the `1` in `array([x, y, z, 1])`, the last of four homogeneous coordinates. The `1e-9` in
`stamp.nanosec * 1e-9` converts a unit (see `unit_factors`), and the `1.0` in `1.0 - alpha` is the sum of two shares.
Other constants are needed only by ROS (see `bookkeeping`). Booleans and zeros are not labels, because a search can
switch booleans and add to zeros.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cache

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, document
from pytest_tarl.repairing.bookkeeping import is_bookkeeping
from pytest_tarl.repairing.unit_factors import converts_unit
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

GEOMETRIC = (0.5, 2, 3)  # exponents of roots, areas and volumes
HOMOGENEOUS = 4  # number of homogeneous coordinates in space
_ENUMERATIONS = frozenset({"Enum", "Flag", "IntEnum", "IntFlag", "StrEnum"})


def quantities(analysis: Analysis, operands: Iterable[Operand]) -> list[Operand]:
    """Return the operands that are not labels, in their order."""
    return [operand for operand in operands if not _is_label(analysis, operand)]


def is_member(source: Document, node: ast.expr, texts: Iterable[str]) -> bool:
    """Return whether an expression is an enumeration member or is compared with one (or with anything by `is`).

    `texts` are the modules in which enumerations may be defined.
    """
    names = {name for text in texts for name in _enumerations(text)}
    if _names_member(node, names):
        return True
    around = source.parents.get(node)
    if not isinstance(around, ast.Compare):
        return False
    sides = (around.left, *around.comparators)
    return any(isinstance(op, ast.Is | ast.IsNot) for op in around.ops) or any(
        _names_member(side, names) for side in sides
    )


def _is_label(analysis: Analysis, operand: Operand) -> bool:
    try:
        source = document(operand.span.path, analysis.sources[operand.span.path])
        node = source.find(operand.span)
    except (RepairError, KeyError):
        return False
    if not isinstance(operand.value, bool) and is_member(source, node, analysis.sources.values()):
        return True
    if is_bookkeeping(analysis, source, node):
        return True
    if _is_exponent(source, node) or _is_homogeneous(node, source.parents.get(node)):
        return True
    if converts_unit(source, node) or _is_whole(source, node):
        return True
    changeable = isinstance(operand.value, bool) or operand.value == 0
    return not changeable and _only_truth(source, node)


def _is_exponent(source: Document, node: ast.expr) -> bool:
    """Return whether an expression is a literal exponent that is common in geometry."""
    around = source.parents.get(node)
    power = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Pow) and around.right is node
    return power and isinstance(node, ast.Constant) and node.value in GEOMETRIC


def _is_homogeneous(node: ast.expr, around: ast.AST | None) -> bool:
    """Return whether an expression is the last of four coordinates of a point or a direction in space."""
    if not isinstance(around, ast.List | ast.Tuple) or len(around.elts) != HOMOGENEOUS:
        return False
    computed = any(not isinstance(one, ast.Constant | ast.UnaryOp) for one in around.elts)
    return computed and around.elts[-1] is node and isinstance(node, ast.Constant) and node.value == 1


def _is_whole(source: Document, node: ast.expr) -> bool:
    """Return whether an expression is the 1 of a mean such as `alpha * x + (1.0 - alpha) * y`."""
    match source.parents.get(node):
        case ast.BinOp(
            left=ast.Constant(value=1) as left, op=ast.Sub(), right=ast.Name() | ast.Attribute() as right
        ):
            share, parts = ast.unparse(right), ast.walk(source.statement(node))
            uses = [each for each in parts if isinstance(each, ast.Name | ast.Attribute)]
            return left is node and sum(ast.unparse(each) == share for each in uses) > 1
    return False


def _only_truth(source: Document, node: ast.expr) -> bool:
    """Return whether a condition uses only the truth of a value, and not the value itself."""
    inner: ast.AST = node
    for around in source.ancestors(node):
        if isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.Not):
            return True
        if isinstance(around, ast.If | ast.While | ast.IfExp | ast.Assert):
            return around.test is inner
        if not isinstance(around, ast.BoolOp):
            return False
        inner = around
    return False


def _names_member(node: ast.expr, names: set[str]) -> bool:
    """Return whether an expression reads `Mode.LEVEL` or `module.Mode.LEVEL`."""
    return isinstance(node, ast.Attribute) and ast.unparse(node.value).rpartition(".")[2] in names


@cache
def _enumerations(text: str) -> frozenset[str]:
    """Return the names of the enumerations that a module defines at its top level."""
    if "Enum" not in text and "Flag" not in text:
        return frozenset()
    return frozenset(
        node.name
        for node in ast.parse(text).body
        if isinstance(node, ast.ClassDef)
        and any(ast.unparse(base).rpartition(".")[2] in _ENUMERATIONS for base in node.bases)
    )
