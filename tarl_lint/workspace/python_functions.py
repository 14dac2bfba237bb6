"""Functions of an interpreted file: what their parameters are bound to, and whether they are generators."""

from __future__ import annotations

import ast
from typing import Any

from tarl_lint.workspace.python_values import Function, Unknown


def arguments(function: Function, args: list[Any], keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the names inside a function when it is called."""
    spec, line = function.node.args, function.node.lineno
    positional = [one.arg for one in (*spec.posonlyargs, *spec.args)]
    stated = [*positional, *(one.arg for one in spec.kwonlyargs)]
    inside = {name: function.defaults.get(name, Unknown(line, "an argument")) for name in stated}
    inside |= dict(zip(positional, args, strict=False))
    inside |= {name: value for name, value in keywords.items() if name in stated}
    if spec.vararg is not None:
        inside[spec.vararg.arg] = tuple(args[len(positional) :])
    if spec.kwarg is not None:
        inside[spec.kwarg.arg] = {name: value for name, value in keywords.items() if name not in stated}
    return inside


def yields(node: ast.AST) -> bool:
    """Return whether a function contains `yield`, apart from the functions inside it."""
    pending = list(ast.iter_child_nodes(node))
    while pending:
        one = pending.pop()
        if isinstance(one, ast.Yield | ast.YieldFrom):
            return True
        if not isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.ClassDef):
            pending += ast.iter_child_nodes(one)
    return False
