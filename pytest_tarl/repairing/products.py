"""Constants that are multiplied with each other: a factor on one of them is the same mutant as on any other."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.document import Document, document
from pytest_tarl.patching.mutate import is_integral
from tarl_lint.api import Analysis
from tarl_lint.model import Operand

Product = tuple[str, int, int]  # file, and the offsets of the outermost expression


def one_of_each(analysis: Analysis, operands: Sequence[Operand]) -> tuple[list[Operand], list[Operand]]:
    """Return the operands of which a search needs to move only these, and those that do nothing else than they do.

    Of a product's constants the first in the given order stays, and so does what another use in the same statement
    belongs to, as `LIMIT` in `max(-LIMIT, min(LIMIT, x))`: these are moved together.
    """
    kept: list[Operand] = []
    same: list[Operand] = []
    taken: set[Product] = set()
    uses = [(operand.site, operand.code, abs(operand.value or 0)) for operand in operands]
    for operand, use in zip(operands, uses, strict=True):
        product = _product(analysis, operand) if uses.count(use) == 1 else None
        if product is not None and product in taken:
            same.append(operand)
            continue
        kept.append(operand)
        if product is not None:
            taken.add(product)
    return kept, same


def _product(analysis: Analysis, operand: Operand) -> Product | None:
    """Return the product that an operand is a factor of; None where it is none, or does not move by a factor."""
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
    """Climb while the value around is proportional to the one inside."""
    top = node
    for around in source.ancestors(node):
        factor = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Mult)
        divided = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Div) and around.left is top
        negated = isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.USub)
        if not isinstance(around, ast.expr) or not (factor or divided or negated):
            break
        top = around
    return top
