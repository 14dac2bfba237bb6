"""Tests that show a variable to be a number: `isinstance(x, (int, float))`."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final

NUMBERS: Final = frozenset(["int", "float", "bool"])
LEAVES: Final = (ast.Return, ast.Raise, ast.Continue, ast.Break)


def shown(test: ast.expr, body: Sequence[ast.AST] = ()) -> frozenset[str]:
    """Return the variables that are numbers where a test holds and that `body` does not assign."""
    return _in(test, holds=True) - _assigned(body) if "isinstance" in _names(test) else frozenset()


def shown_after(branch: ast.stmt, rest: Sequence[ast.AST]) -> frozenset[str]:
    """Return the variables that are numbers after an `if` that leaves the block for all other values."""
    if not isinstance(branch, ast.If) or branch.orelse or not isinstance(branch.body[-1], LEAVES):
        return frozenset()
    return _in(branch.test, holds=False) - _assigned(rest)


def _in(test: ast.expr, *, holds: bool) -> frozenset[str]:
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return _in(test.operand, holds=not holds)
    if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And if holds else ast.Or):
        return frozenset[str]().union(*(_in(part, holds=holds) for part in test.values))
    if not holds or not isinstance(test, ast.Call) or len(test.args) != 2:
        return frozenset()
    tested, kinds = test.args
    listed = kinds.elts if isinstance(kinds, ast.Tuple) else [kinds]
    numeric = all(isinstance(one, ast.Name) and one.id in NUMBERS for one in listed)
    named = isinstance(test.func, ast.Name) and test.func.id == "isinstance"
    return frozenset([tested.id]) if named and numeric and isinstance(tested, ast.Name) else frozenset()


def _assigned(body: Sequence[ast.AST]) -> frozenset[str]:
    return frozenset(
        part.id
        for node in body
        for part in ast.walk(node)
        if isinstance(part, ast.Name) and not isinstance(part.ctx, ast.Load)
    )


def _names(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
