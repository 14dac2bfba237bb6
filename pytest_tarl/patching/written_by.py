"""Find the statements of a function that compute a value."""

from __future__ import annotations

import ast

from pytest_tarl.patching.document import Document

STEPS = 3  # maximum number of assignments between a literal and the place where its value is published


def writers(source: Document, node: ast.expr, code: str) -> list[ast.stmt]:
    """Return the statements of a function that compute the value of `code`, nearest to `node` first.

    `node` is an expression in the function, and `code` is a name or attribute there. Assignments to `code` come first,
    followed by assignments to the names that these read.
    """
    function = source.function(source.statement(node))
    if function is None:
        return []
    assignments = [
        one for one in ast.walk(function) if isinstance(one, ast.Assign | ast.AugAssign | ast.AnnAssign)
    ]
    found: dict[ast.stmt, None] = {}
    wanted = {code}
    for _ in range(STEPS):
        new = [one for one in assignments if one not in found and not wanted.isdisjoint(_written(one))]
        found |= dict.fromkeys(new)
        wanted = {name for one in new if one.value is not None for name in _read(one.value)}
    return list(found)


def _written(assignment: ast.Assign | ast.AugAssign | ast.AnnAssign) -> set[str]:
    targets = assignment.targets if isinstance(assignment, ast.Assign) else [assignment.target]
    parts = [part for target in targets for part in _parts(target)]
    return {ast.unparse(part) for part in parts}


def _parts(target: ast.expr) -> list[ast.expr]:
    if isinstance(target, ast.Tuple | ast.List):
        return [part for each in target.elts for part in _parts(each)]
    return [target]


def _read(value: ast.expr) -> set[str]:
    """Return the names and attributes that an expression reads: for `a.b`, this is `a.b` and not `a`."""
    bases = {one.value for one in ast.walk(value) if isinstance(one, ast.Attribute)}
    names = (one for one in ast.walk(value) if isinstance(one, ast.Name | ast.Attribute) and one not in bases)
    return {ast.unparse(one) for one in names}
