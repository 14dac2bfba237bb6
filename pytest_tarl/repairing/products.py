"""Constants that need not be searched, because a factor on another constant has the same effect.

This holds for constants that are factors of one product, and for constants that a constructor stores for later use.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import is_integral
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

Product = tuple[str, int, int]  # file, start offset and end offset of the outermost expression


def one_of_each(analysis: Analysis, operands: Sequence[Operand]) -> tuple[list[Operand], list[Operand]]:
    """Split operands into those that a search must move, and those equivalent to them.

    In each product, the search must move the first constant (in the given order). It must also move a constant that a
    statement uses twice, such as `LIMIT` in `max(-LIMIT, min(LIMIT, x))`, because both uses move together. The operand
    in `self.limit = limit` of a constructor is equivalent to the later use of that attribute.
    """
    stored = {operand for operand in operands if _stored(analysis, operand)}
    used = {one.definition for one in operands if one not in stored and one.definition is not None}
    kept: list[Operand] = []
    same: list[Operand] = []
    taken: set[Product] = set()
    uses = [(operand.site, operand.code, abs(operand.value or 0)) for operand in operands]
    for operand, use in zip(operands, uses, strict=True):
        if operand in stored and operand.definition in used:
            same.append(operand)
            continue
        product = _product(analysis, operand) if uses.count(use) == 1 else None
        if product is not None and product in taken:
            same.append(operand)
            continue
        kept.append(operand)
        if product is not None:
            taken.add(product)
    return kept, same


def _stored(analysis: Analysis, operand: Operand) -> bool:
    """Return whether the operand is a parameter that a constructor stores unchanged."""
    if operand.literal or operand.site.qualname.rpartition(".")[2] != "__init__":
        return False
    try:
        source = document(operand.span.path, analysis.sources[operand.span.path])
        node = source.find(operand.span)
    except (RepairError, KeyError):
        return False
    statement = source.statement(node)
    assigns = isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is node
    return assigns and isinstance(node, ast.Name)


def _product(analysis: Analysis, operand: Operand) -> Product | None:
    """Return the product of which an operand is a factor, or None if there is no such product."""
    if operand.value == 0 or isinstance(operand.value, bool):
        return None
    path = operand.span.path
    try:
        source = document(path, analysis.sources[path])
        node = source.find(operand.span)
        if is_integral(analysis, operand):
            return None
    except (RepairError, KeyError):
        return None
    top = _outermost(source, node)
    return None if top is node else (path, source.start(top), source.end(top))


def _outermost(source: Document, node: ast.expr) -> ast.expr:
    """Return the outermost expression whose value is proportional to that of the node."""
    top = node
    for around in source.ancestors(node):
        factor = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Mult)
        divided = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Div) and around.left is top
        negated = isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.USub)
        if not isinstance(around, ast.expr) or not (factor or divided or negated):
            break
        top = around
    return top
