"""Message fields that are built by several statements, such as `msg.data += b`.

The program has no single expression for the published value of such a field. The field is therefore changed just before
the publish call.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pytest_tarl.patching.document import Document
from pytest_tarl.patching.integer_fields import in_integer_field

FEWEST = 2  # minimum number of statements that write the field


@dataclass(frozen=True, eq=False, slots=True)
class Built:
    """A field of a message, such as `linear.x`, and the statements in a function that write it."""

    field: str
    writes: tuple[ast.Assign | ast.AugAssign, ...]


def built_fields(source: Document, statement: ast.stmt) -> list[tuple[ast.expr, Built]]:
    """Return (message, field) for each field of a published message that several statements build.

    Every path to the publish call must set the field, or the function must create the message. Otherwise the field
    might keep its value from an earlier call, and a factor would be applied to it again and again. Fields with strings
    or integers are left out.
    """
    published = _published(statement)
    function = source.function(statement)
    if published is None or function is None:
        return []
    message, above = ast.unparse(published), list(_before(source, statement, function))
    made = _is_made(above, message)
    found: list[tuple[ast.expr, Built]] = []
    for field, writes in _writes(function, message, statement).items():
        target = f"{message}.{field}"
        sure = made or any(_sets(before, target) for before in above)
        if len(writes) >= FEWEST and sure and _is_number(source, writes):
            found.append((published, Built(field, tuple(writes))))
    return found


def _published(statement: ast.stmt) -> ast.expr | None:
    """Return the name or attribute that a statement publishes, or None."""
    call = statement.value if isinstance(statement, ast.Expr) else None
    if not isinstance(call, ast.Call) or len(call.args) != 1 or call.keywords:
        return None
    named = isinstance(call.func, ast.Attribute) and call.func.attr == "publish"
    return call.args[0] if named and isinstance(call.args[0], ast.Name | ast.Attribute) else None


def _writes(
    function: ast.AST, message: str, statement: ast.stmt
) -> dict[str, list[ast.Assign | ast.AugAssign]]:
    """Map each field of a message to the statements before `statement` that write it."""
    found: dict[str, list[ast.Assign | ast.AugAssign]] = {}
    for node in ast.walk(function):
        if not isinstance(node, ast.Assign | ast.AugAssign) or node.lineno >= statement.lineno:
            continue
        target = node.target if isinstance(node, ast.AugAssign) else node.targets[0]
        code = ast.unparse(target)
        single = isinstance(node, ast.AugAssign) or len(node.targets) == 1
        if single and isinstance(target, ast.Attribute) and code.startswith(f"{message}."):
            found.setdefault(code.removeprefix(f"{message}."), []).append(node)
    return found


def _before(source: Document, statement: ast.stmt, function: ast.AST) -> Iterator[ast.stmt]:
    """Yield the statements that always run before a statement of a function."""
    inner: ast.stmt = statement
    while True:
        block = source.block(inner)
        yield from block[: block.index(inner)]
        around = source.parents[inner]
        if around is function or not isinstance(around, ast.stmt):
            return
        inner = around


def _sets(statement: ast.stmt, target: str) -> bool:
    """Return whether a statement is certain to assign a target."""
    if isinstance(statement, ast.Assign):
        return any(ast.unparse(one) == target for one in statement.targets)
    if isinstance(statement, ast.If):
        return _set_in(statement.body, target) and _set_in(statement.orelse, target)
    return isinstance(statement, ast.With) and _set_in(statement.body, target)


def _set_in(block: Sequence[ast.stmt], target: str) -> bool:
    return any(_sets(one, target) or _leaves(one) for one in block)


def _leaves(statement: ast.stmt) -> bool:
    """Return whether a statement never continues with the next one."""
    return isinstance(statement, ast.Return | ast.Raise | ast.Continue | ast.Break)


def _is_made(above: Sequence[ast.stmt], message: str) -> bool:
    """Return whether one of the statements `above` a publish call creates the message."""
    return any(
        isinstance(one, ast.Assign)
        and isinstance(one.value, ast.Call)
        and any(ast.unparse(target) == message for target in one.targets)
        for one in above
    )


def _is_number(source: Document, writes: Sequence[ast.Assign | ast.AugAssign]) -> bool:
    """Return whether a field is certain to hold a number that may be a fraction."""
    arithmetic = ast.Add | ast.Sub | ast.Mult | ast.Div
    counted = any(in_integer_field(source, one.value) for one in writes)
    texts = any(isinstance(one.value, ast.JoinedStr) or _is_text(one.value) for one in writes)
    computed = any(
        isinstance(one.op, arithmetic) if isinstance(one, ast.AugAssign) else _computes(one.value)
        for one in writes
    )
    return computed and not counted and not texts


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str | bool)


def _computes(node: ast.expr) -> bool:
    """Return whether an expression is arithmetic or a number."""
    if isinstance(node, ast.UnaryOp):
        return isinstance(node.op, ast.USub)
    if isinstance(node, ast.BinOp):
        return not _is_text(node.left) and not isinstance(node.op, ast.Mod)
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)
