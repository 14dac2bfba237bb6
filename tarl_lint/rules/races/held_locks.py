"""Find the locks held at a place in a function, by the syntax of that function alone."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final

from tarl_lint.evidence import Outline
from tarl_lint.trees import last_name, walk

LOCKISH: Final = re.compile(r"lock|mutex|sem(aphore)?$|cond(ition)?$", re.I)
FUNCTIONS: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
TRY: Final = "acquire if free"
EXITS: Final = (ast.Return, ast.Continue, ast.Break, ast.Raise)


def locks_around(node: ast.AST, outline: Outline) -> frozenset[str]:
    """Return the names of the locks held at a node."""
    known = outline.held.get(node)
    if known is None:
        known = outline.held[node] = _around(node, outline)
    return known


def tried_around(node: ast.AST, outline: Outline) -> frozenset[str]:
    """Return the locks around a node that the function only takes if they are free: `acquire(blocking=False)`.

    Such a lock prevents an activity from running twice at the same time. Code that only needs the data of the
    activity is not expected to take this lock.
    """
    function = outline.scope(node, FUNCTIONS)
    if function is None:
        return frozenset()
    tried = {name for name, action, _ in _calls(function, outline) if action == TRY}
    return locks_around(node, outline) & tried


def _around(node: ast.AST, outline: Outline) -> frozenset[str]:
    found: set[str] = set()
    function: ast.AST | None = None
    for outer in outline.around(node):
        if isinstance(outer, (ast.With, ast.AsyncWith)):
            found |= set(_taken(outer, outline))
        if isinstance(outer, (ast.FunctionDef, ast.AsyncFunctionDef)):
            function = outer
            break
    if function is not None:
        found |= _acquired(node, function, outline)
    return frozenset(found)


def _taken(statement: ast.With | ast.AsyncWith, outline: Outline) -> Iterator[str]:
    for item in statement.items:
        if name := lock_name(item.context_expr, outline):
            yield name


def _acquired(node: ast.AST, function: ast.AST, outline: Outline) -> set[str]:
    """Return the locks acquired above a node and released below it."""
    line = getattr(node, "lineno", 0)
    above: set[str] = set()
    below: set[str] = set()
    for name, action, where in _calls(function, outline):
        if action in ("acquire", TRY) and where <= line:
            above.add(name)
        elif action == "release" and where >= line:
            below.add(name)
    return above & below


def _calls(function: ast.AST, outline: Outline) -> list[tuple[str, str, int]]:
    """Return (lock, method, line) of each method call on a lock; the method is TRY if it acquires without waiting."""
    known = outline.lock_calls.get(function)
    if known is None:
        calls = [n for n in walk(function) if isinstance(n, ast.Call)]
        named = [(lock_name(c.func.value, outline), c) for c in calls if isinstance(c.func, ast.Attribute)]
        known = [(n, _method(c), c.lineno) for n, c in named if n]
        outline.lock_calls[function] = known
    return known


def _method(call: ast.Call) -> str:
    """Return the method that is called, or TRY if it acquires a lock without waiting."""
    given = [k.value for k in call.keywords if k.arg == "blocking"] or call.args[:1]
    name = last_name(call.func)
    return (
        TRY
        if name == "acquire" and any(isinstance(v, ast.Constant) and v.value is False for v in given)
        else name
    )


def lock_name(expr: ast.expr, outline: Outline) -> str:
    """Return the last part of a lock's name; for a condition variable, of its lock's name; "" for anything else."""
    if isinstance(expr, ast.Call):
        expr = expr.func.value if isinstance(expr.func, ast.Attribute) else expr.func
    name = last_name(expr)
    made = outline.locks.get(name)
    return made if made is not None else name if LOCKISH.search(name) else ""


def asked_before(node: ast.AST, outline: Outline) -> frozenset[str]:
    """Return the locks that the function takes after a test that only decides whether to return early.

    If `if self.stamp == self.seen: return` stands before `with self.lock:`, the test only saves time. The value
    that counts is read later, under the lock.
    """
    current = node
    for outer in outline.around(node):
        if isinstance(outer, ast.If):
            leaves = current is outer.test and isinstance(outer.body[-1], EXITS)
            return _later(outer, outline) if leaves else frozenset()
        if not isinstance(outer, ast.expr):
            return frozenset()
        current = outer
    return frozenset()


def _later(statement: ast.If, outline: Outline) -> frozenset[str]:
    """Return the locks that the function takes after a statement."""
    function = outline.scope(statement, FUNCTIONS)
    if function is None:
        return frozenset()
    line = statement.body[-1].lineno
    taken = {
        name
        for other in walk(function)
        if isinstance(other, (ast.With, ast.AsyncWith)) and other.lineno > line
        for name in _taken(other, outline)
    }
    return frozenset(
        taken | {n for n, action, at in _calls(function, outline) if action == "acquire" and at > line}
    )


def in_loop(node: ast.AST, outline: Outline) -> bool:
    """Return whether a `while` repeats a node within its function."""
    for outer in outline.around(node):
        if isinstance(outer, ast.While):
            return True
        if isinstance(outer, FUNCTIONS):
            return False
    return False
