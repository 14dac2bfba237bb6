"""The name of a program's node, from the syntax."""

from __future__ import annotations

import ast
from typing import Final

from tarl_lint.trees import walk

NAMING: Final = frozenset(["init_node", "create_node"])
NODES: Final = frozenset(["Node", "LifecycleNode"])


def node_name(tree: ast.Module) -> str:
    """Return the name of the first node that a file starts; "" if the name is computed or there is no node."""
    bases = {id(c): _names_node(c) for c in ast.walk(tree) if isinstance(c, ast.ClassDef)}
    inside = {id(n) for c in ast.walk(tree) if bases.get(id(c)) for n in ast.walk(c)}
    for call in walk(tree):
        if isinstance(call, ast.Call) and (_called(call) in NAMING or (id(call) in inside and _super(call))):
            named = [k.value for k in call.keywords if k.arg in ("name", "node_name")]
            for value in (*call.args[:1], *named):
                if isinstance(value, ast.Constant) and isinstance(value.value, str):
                    return value.value
    return ""


def _names_node(cls: ast.ClassDef) -> bool:
    return any(_last(base) in NODES for base in cls.bases)


def _super(call: ast.Call) -> bool:
    """Return whether a call is `super().__init__(...)`."""
    function = call.func
    return (
        isinstance(function, ast.Attribute)
        and function.attr == "__init__"
        and isinstance(function.value, ast.Call)
        and _last(function.value.func) == "super"
    )


def _called(call: ast.Call) -> str:
    return _last(call.func)


def _last(expr: ast.expr) -> str:
    if isinstance(expr, ast.Attribute):
        return expr.attr
    return expr.id if isinstance(expr, ast.Name) else ""
