"""Check whether code already raises, or does not run, while a variable is None (before the first message)."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from pytest_tarl.patching.bindings import Scope
from pytest_tarl.patching.document import Document


def is_checked(source: Document, place: ast.AST, code: str) -> bool:
    """Return whether code at a place cannot complete while `code` is None: it does not run, or it raises."""
    if isinstance(place, ast.stmt) and _relies_on(place, code):
        return True
    inner = place
    for outer in source.ancestors(place):
        if isinstance(outer, Scope):
            return _checked_before(source, inner, code)
        if isinstance(inner, ast.stmt) and _checked_before(source, inner, code):
            return True
        if (
            isinstance(outer, ast.If | ast.While)
            and inner in outer.body
            and _implies(outer.test, code, present=True)
        ):
            return True
        inner = outer
    return False


def _checked_before(source: Document, statement: ast.AST, code: str) -> bool:
    """Return whether an earlier statement of the block raises, leaves the block or waits while `code` is None."""
    if not isinstance(statement, ast.stmt):
        return False
    block = source.block(statement)
    for earlier in block[: next(i for i, each in enumerate(block) if each is statement)]:
        if _relies_on(earlier, code):
            return True
        if not isinstance(earlier, ast.If | ast.While):
            continue
        leaves = isinstance(earlier.body[-1], ast.Return | ast.Raise | ast.Continue | ast.Break)
        decides = leaves if isinstance(earlier, ast.If) else not _breaks(earlier)
        if decides and _implies(earlier.test, code, present=False):
            return True
    return False


def _relies_on(statement: ast.stmt, code: str) -> bool:
    """Return whether a statement always evaluates an operation on `code` that raises for None."""
    if hasattr(statement, "body"):
        return False
    waiting: list[ast.AST] = [statement]
    while waiting:
        node = waiting.pop()
        if any(ast.unparse(each) == code for each in _calculated(node)):
            return True
        if isinstance(node, ast.BoolOp):
            waiting.append(node.values[0])
        elif isinstance(node, ast.IfExp):
            waiting.append(node.test)
        elif not isinstance(node, ast.Lambda | ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
            waiting += ast.iter_child_nodes(node)
    return False


def _calculated(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the operands of an expression that would raise if they were None."""
    if isinstance(node, ast.BinOp):
        yield from (node.left, node.right)
    elif isinstance(node, ast.UnaryOp) and not isinstance(node.op, ast.Not):
        yield node.operand
    elif isinstance(node, ast.Attribute | ast.Subscript):
        yield node.value
    elif isinstance(node, ast.Compare) and all(
        isinstance(op, ast.Lt | ast.LtE | ast.Gt | ast.GtE) for op in node.ops
    ):
        yield node.left
        yield node.comparators[0]


def _breaks(loop: ast.While) -> bool:
    return any(isinstance(node, ast.Break) for node in ast.walk(loop))


def _implies(test: ast.expr, code: str, present: bool) -> bool:
    """Return whether a true test (`present=True`) or a false one (`present=False`) implies that `code` is not None."""
    if isinstance(test, ast.BoolOp):
        decisive = ast.And if present else ast.Or
        return isinstance(test.op, decisive) and any(_implies(each, code, present) for each in test.values)
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return _implies(test.operand, code, not present)
    if isinstance(test, ast.Compare) and len(test.ops) == 1 and isinstance(test.comparators[0], ast.Constant):
        asked = ast.IsNot if present else ast.Is
        none = test.comparators[0].value is None
        return none and isinstance(test.ops[0], asked) and ast.unparse(test.left) == code
    return present and ast.unparse(test) == code
