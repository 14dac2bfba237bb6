"""Traversal of syntax trees. It is faster than the traversal in `ast`, because it visits only fields with nodes."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from typing import Final

ATOMS: Final = frozenset(
    ["id", "attr", "arg", "name", "asname", "module", "level", "ctx", "op", "ops", "kind", "type_comment", "names",
     "conversion", "is_async", "simple", "rest", "kwd_attrs", "type_ignores", "tag", "lineno"]
)  # fmt: skip
ALIASES: Final = (ast.Import, ast.ImportFrom)  # kinds of statements whose imported names are nodes


def children(node: ast.AST) -> list[ast.AST]:
    """Return the child nodes of a node, in order. Operators and contexts are left out."""
    found: list[ast.AST] = []
    kind = type(node)
    names = _HOLDING.get(kind)
    if names is None:
        names = _HOLDING[kind] = _holding(kind)
    for name in names:
        value = getattr(node, name, None)
        if isinstance(value, list):
            found += [item for item in value if isinstance(item, ast.AST)]
        elif isinstance(value, ast.AST):
            found.append(value)
    return found


def walk(*trees: ast.AST) -> Iterator[ast.AST]:
    """Yield nodes and all their descendants, in source order."""
    pending = [*reversed(trees)]
    while pending:
        node = pending.pop()
        yield node
        inside = children(node)
        inside.reverse()
        pending += inside


def outside_functions(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield statements, and the statements inside them, in source order; skip bodies of functions and classes."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            continue
        for part in (statement, *getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
            yield from outside_functions(getattr(part, "body", ()))
        for name in ("orelse", "finalbody"):
            yield from outside_functions(getattr(statement, name, ()))


def last_name(expr: ast.expr) -> str:
    """Return the last part of a dotted name; "" for any other expression."""
    return expr.attr if isinstance(expr, ast.Attribute) else expr.id if isinstance(expr, ast.Name) else ""


def argument(call: ast.Call, place: int, *names: str) -> ast.expr | None:
    """Return an argument of a call by its keyword, or else by its place; None if the call does not pass it."""
    named = next((one.value for one in call.keywords if one.arg in names), None)
    return named if named is not None else call.args[place] if len(call.args) > place else None


def _holding(kind: type[ast.AST]) -> tuple[str, ...]:
    if kind is ast.Constant:
        return ()
    return tuple(n for n in kind._fields if n not in ATOMS or (n == "names" and kind in ALIASES))


_HOLDING: dict[type[ast.AST], tuple[str, ...]] = {}
