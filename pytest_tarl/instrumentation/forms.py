"""Build the ast nodes that record values, with source positions.

A new node gets the position of the original code that runs at that moment. Line events, tracebacks and their carets are
therefore the same as in the original program.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable
from typing import TypedDict

from pytest_tarl.instrumentation.constants import BUFFER, FLOAT, HOOK, TYPE, Mark

_BRANCHING = (ast.BoolOp, ast.IfExp, ast.NamedExpr)
INLINED_COMPREHENSIONS = sys.version_info >= (3, 12)
_FIRST = {
    ast.Attribute: "value",
    ast.Await: "value",
    ast.BinOp: "left",
    ast.BoolOp: "values",
    ast.Call: "func",
    ast.Compare: "left",
    ast.IfExp: "test",
    ast.List: "elts",
    ast.NamedExpr: "value",
    ast.Set: "elts",
    ast.Starred: "value",
    ast.Subscript: "value",
    ast.Tuple: "elts",
    ast.UnaryOp: "operand",
    ast.Yield: "value",
    ast.YieldFrom: "value",
}


class Where(TypedDict):
    """The position of an ast node: first and last line and column."""

    lineno: int
    col_offset: int
    end_lineno: int | None
    end_col_offset: int | None


def where(node: ast.expr | ast.stmt | ast.keyword) -> Where:
    """Return the position of `node`, for a new node in its place."""
    return Where(
        lineno=node.lineno,
        col_offset=node.col_offset,
        end_lineno=node.end_lineno,
        end_col_offset=node.end_col_offset,
    )


def start_of(node: ast.expr | ast.stmt) -> Where:
    """Return the start of the part of `node` that runs first, as an empty range.

    The range must be empty: if a method call spans several lines, CPython places the call at the end of its range.
    """
    return collapsed(where(first_evaluated(node) if isinstance(node, ast.expr) else node))


def collapsed(at: Where) -> Where:
    """Return the empty range at the start of a range."""
    line, column = at["lineno"], at["col_offset"]
    return Where(lineno=line, col_offset=column, end_lineno=line, end_col_offset=column)


def end_of(node: ast.expr, then: Where) -> Where:
    """Return a position for new code that runs between an expression and the code at `then`.

    If the branches of an expression are on several lines, no single line is its last; the result is then `then`. (Code
    without a line number is not an option: CPython 3.13.0 copies such blocks and then runs both copies.)
    """
    several = node.end_lineno != node.lineno
    return collapsed(then) if several and isinstance(node, _BRANCHING) else where(node)


def first_evaluated(node: ast.expr) -> ast.expr:
    """Return the part of an expression that runs first, where a debugger would stop."""
    while True:
        if INLINED_COMPREHENSIONS and isinstance(node, (ast.ListComp, ast.SetComp, ast.DictComp)):
            node = node.generators[0].iter
            continue
        inner = getattr(node, _FIRST.get(type(node), ""), None)
        if isinstance(inner, list):
            inner = inner[0] if inner else None
        if not isinstance(inner, ast.expr):
            return node
        node = inner


def recorded(value: ast.expr, number: int, then: Where | None = None) -> ast.Call:
    """Build `hook(number, value)`, which returns `value`; the code at `then` uses the result."""
    start = start_of(value)
    return ast.Call(
        func=_marked(HOOK, start),
        args=[ast.Constant(number, **start), value],
        keywords=[],
        **end_of(value, then or start),
    )


def note(name: str, number: int, at: Where, *, inline: bool) -> ast.stmt:
    """Build the statement that records the value of a plain name."""
    value = ast.Name(name, ast.Load(), **at)
    by_hook = _called(value, number, at)
    if not inline:
        return by_hook
    plain = _is_float(name, at)
    appended = _appended(ast.Name(name, ast.Load(), **at), number, at)
    return ast.If(plain, appended, [by_hook], **at)


def note_constant(value: float, number: int, at: Where, *, inline: bool) -> list[ast.stmt]:
    """Build the statements that record a value known in advance: a boolean or 0."""
    constant = ast.Constant(value, **at)
    if inline:
        return _appended(constant, number, at)
    return [_called(constant, number, at)]


def note_all(events: Iterable[tuple[str, int]], at: Where) -> ast.stmt:
    """Build one statement that records several names of floats, with their site numbers."""
    entries: list[ast.expr] = []
    for name, number in events:
        entries += [ast.Constant(number, **at), ast.Name(name, ast.Load(), **at)]
    method = ast.Attribute(_marked(BUFFER, at), "extend", ast.Load(), **at)
    return ast.Expr(ast.Call(method, [ast.Tuple(entries, ast.Load(), **at)], [], **at), **at)


def all_floats(inputs: Iterable[str], at: Where) -> ast.expr:
    """Build the condition that every name has a value of the exact class `float`."""
    tests: list[ast.expr] = [_is_float(name, at) for name in inputs]
    return tests[0] if len(tests) == 1 else ast.BoolOp(ast.And(), tests, **at)


def truth(test: ast.expr) -> ast.expr:
    """Build an expression for the truth value of a condition, which evaluates each operand once, as a jump does."""
    if isinstance(test, ast.Compare) and len(test.ops) == 1:
        return test
    at = where(test)
    return ast.IfExp(test, ast.Constant(True, **at), ast.Constant(False, **at), **at)


def reached(call: ast.Call, number: int) -> ast.Call:
    """Build a call that records 0 after its arguments are evaluated, but before the function runs.

    A publish call can run other nodes and the world, so an event recorded after it could belong to a later step.
    """
    if call.keywords:
        last = call.keywords[-1]
        changed = ast.keyword(last.arg, _then(last.value, number), **where(last))
        return ast.Call(call.func, call.args, [*call.keywords[:-1], changed], **where(call))
    *before, final = call.args
    if isinstance(final, ast.Starred):
        final = ast.Starred(_then(final.value, number), final.ctx, **where(final))
    else:
        final = _then(final, number)
    return ast.Call(call.func, [*before, final], [], **where(call))


def _then(value: ast.expr, number: int) -> ast.expr:
    """Build `(value, hook(number, 0.0))[0]`."""
    at = where(value)
    hook = ast.Call(_marked(HOOK, at), _arguments(number, at), [], **at)
    both = ast.Tuple([value, hook], ast.Load(), **at)
    return ast.Subscript(both, ast.Constant(0, **at), ast.Load(), **at)


def _arguments(number: int, at: Where) -> list[ast.expr]:
    return [ast.Constant(number, **at), ast.Constant(0.0, **at)]


def _is_float(name: str, at: Where) -> ast.Compare:
    kind = ast.Call(_marked(TYPE, at), [ast.Name(name, ast.Load(), **at)], [], **at)
    return ast.Compare(kind, [ast.Is()], [_marked(FLOAT, at)], **at)


def _called(value: ast.expr, number: int, at: Where) -> ast.Expr:
    hook = _marked(HOOK, at)
    return ast.Expr(ast.Call(hook, [ast.Constant(number, **at), value], [], **at), **at)


def _appended(value: ast.expr, number: int, at: Where) -> list[ast.stmt]:
    return [_append(ast.Constant(number, **at), at), _append(value, at)]


def _append(entry: ast.expr, at: Where) -> ast.stmt:
    # in this form, CPython 3.11 and later have a fast instruction for a method call on a list
    method = ast.Attribute(_marked(BUFFER, at), "append", ast.Load(), **at)
    return ast.Expr(ast.Call(method, [entry], [], **at), **at)


def _marked(mark: Mark, at: Where) -> ast.Constant:
    """Build a mark, which `constants.bound` replaces."""
    return ast.Constant(mark, **at)
