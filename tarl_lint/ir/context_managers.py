"""Generators decorated with `contextmanager`, as two functions: what runs before and after the body of the `with`.

    @contextmanager                            def paused():
    def paused():                                  stop()
        stop()                      becomes        def <leave>():
        try:                                           start()
            yield 1                                return 1, <leave>
        finally:
            start()

If the `yield` is in a branch or a loop, or if there are several, the function stays a generator.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from tarl_lint.ir.scopes import Scope, collect
from tarl_lint.trees import last_name, walk

LEAVE: Final = "<leave>"  # name of the function that runs after the body of the `with`
DECORATORS: Final = frozenset(["contextmanager", "asynccontextmanager"])
_INNER: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)


class _Parts(NamedTuple):
    """The statements before the `yield` of a generator, the `yield` itself, and the statements after it."""

    before: list[ast.stmt]
    place: ast.Yield
    after: list[ast.stmt]


def divided(node: ast.FunctionDef | ast.AsyncFunctionDef) -> Sequence[ast.stmt]:
    """Return the body of a function; if the function is the generator of a context manager, return it in two parts."""
    if not any(last_name(d) in DECORATORS for d in node.decorator_list) or _yields(node.body) != 1:
        return node.body
    return _rebuilt(node.body, node) or node.body


def _rebuilt(
    body: Sequence[ast.stmt], function: ast.FunctionDef | ast.AsyncFunctionDef
) -> list[ast.stmt] | None:
    """Return a body that returns what the generator yields, and the function that does the rest."""
    parts = _parts(body)
    if parts is None:
        return None
    before, place, after = parts
    ours, rest = Scope("function", ""), Scope("function", "")
    ours.bound.update(a.arg for a in walk(function.args) if isinstance(a, ast.arg))
    collect(ours, before)
    collect(rest, after)
    shared = sorted(rest.bound & ours.bound - ours.globals)
    said: list[ast.stmt] = [ast.Global(sorted(ours.globals))] if ours.globals else []
    if shared:
        said.append(ast.Nonlocal(shared))
    value = place.value or ast.Constant(None)
    leave = ast.FunctionDef(LEAVE, _NOTHING, [*said, *(after or [ast.Pass()])], [], None)
    given = ast.Tuple([value, ast.Name(LEAVE, ast.Load())], ast.Load())
    made: list[ast.stmt] = [leave, ast.Return(given)]
    for one in made:
        _place(one, place)
    return _with_end(before, made)


def _with_end(before: Sequence[ast.stmt], made: list[ast.stmt]) -> list[ast.stmt]:
    """Return statements in which other statements replace `_HERE`, which may be inside a `with` or `try`."""
    return [one for statement in before for one in _ended(statement, made)]


def _ended(statement: ast.stmt, made: list[ast.stmt]) -> list[ast.stmt]:
    if statement is _HERE:
        return made
    if not isinstance(statement, (ast.With, ast.AsyncWith, ast.Try)) or not any(
        one is _HERE for one in walk(statement)
    ):
        return [statement]
    body = _with_end(statement.body, made)
    new = (
        ast.Try(body, statement.handlers, [], [])
        if isinstance(statement, ast.Try)
        else type(statement)(statement.items, body)
    )
    return [ast.copy_location(new, statement)]


def _parts(body: Sequence[ast.stmt]) -> _Parts | None:
    """Divide a body at its `yield`; None if this is not possible. In the first part, `_HERE` stands for the `yield`."""
    for number, statement in enumerate(body):
        if not _yields([statement]):
            continue
        before, after = list(body[:number]), list(body[number + 1 :])
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Yield):
            return _Parts([*before, _HERE], statement.value, after)
        inner = _parts(statement.body) if isinstance(statement, (ast.With, ast.AsyncWith, ast.Try)) else None
        if inner is None:
            return None
        if isinstance(statement, ast.Try):
            first, rest = _tried(statement, inner)
        else:
            assert isinstance(statement, (ast.With, ast.AsyncWith))  # noqa: S101 - the other kinds are left above
            new = type(statement)(statement.items, inner.before)
            first, rest = [ast.copy_location(new, statement)], inner.after
        return _Parts([*before, *first], inner.place, [*rest, *after])
    return None


def _tried(statement: ast.Try, inner: _Parts) -> tuple[list[ast.stmt], list[ast.stmt]]:
    """Divide a `try`. Its handlers also catch what the body of the `with` raises; `finally` runs after the body."""
    rest = [*inner.after, *statement.orelse]
    if not statement.handlers:
        return inner.before, [*rest, *statement.finalbody]
    first: list[ast.stmt] = [_try(statement, inner.before, [])] if len(inner.before) > 1 else inner.before
    return first, [_try(statement, rest or [ast.copy_location(ast.Pass(), statement)], statement.finalbody)]


def _try(statement: ast.Try, body: list[ast.stmt], final: list[ast.stmt]) -> ast.stmt:
    return ast.copy_location(ast.Try(body, statement.handlers, [], final), statement)


def _yields(body: Iterable[ast.AST]) -> int:
    """Return the number of `yield`s of a function; `yield from` counts as two."""
    found, pending = 0, list(body)
    while pending:
        node = pending.pop()
        if isinstance(node, (ast.Yield, ast.YieldFrom)):
            found += 1 + isinstance(node, ast.YieldFrom)
        if not isinstance(node, _INNER):
            pending.extend(ast.iter_child_nodes(node))
    return found


def _place(statement: ast.stmt, like: ast.AST) -> None:
    """Give new nodes the place of another one."""
    pending: list[ast.AST] = [statement]
    while pending:
        node = pending.pop()
        if "lineno" in node._attributes and not hasattr(node, "lineno"):
            ast.copy_location(node, like)
            pending.extend(ast.iter_child_nodes(node))


_HERE: Final = ast.Pass()
_NOTHING: Final = ast.arguments(
    posonlyargs=[], args=[], kwonlyargs=[], kw_defaults=[], defaults=[], vararg=None, kwarg=None
)
