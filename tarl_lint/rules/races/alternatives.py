"""Find pairs of callbacks that never run together: an `if` registers one or the other."""

from __future__ import annotations

import ast

from tarl_lint.evidence import Evidence


def never_both(evidence: Evidence, first: object, second: object) -> bool:
    """Return whether the registrations of two threads are in opposite branches of the same `if`."""
    if not isinstance(first, tuple) or not isinstance(second, tuple):
        return False
    ours, theirs = _ways(evidence, first), _ways(evidence, second)
    return any(ours[test] is not theirs[test] for test in ours.keys() & theirs.keys())


def _ways(evidence: Evidence, thread: tuple[object, ...]) -> dict[ast.If, bool]:
    """Return the conditions around the registration of a callback, each with the outcome that leads to it."""
    what = thread[0] if thread else None
    if not isinstance(what, tuple) or len(what) < 3 or not isinstance(what[1], str):
        return {}
    outline = evidence.outline(what[1])
    node: ast.AST | None = outline.call(what[2])
    found: dict[ast.If, bool] = {}
    for outer in outline.around(node) if node is not None else ():
        if isinstance(outer, ast.If):
            found[outer] = node in outer.body
        node = outer
    return found
