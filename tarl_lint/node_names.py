"""The name of a program's node, from the syntax."""

from __future__ import annotations

import ast
from typing import Final

from tarl_lint.trees import walk

NAMING: Final = frozenset(["init_node", "create_node"])
NODES: Final = frozenset(["Node", "LifecycleNode"])
_KEYWORDS: Final = ("name", "node_name")


def node_name(tree: ast.Module) -> str:
    """Return the name of the first node that a file starts; "" if the name is computed or there is no node."""
    within = {
        id(node): cls
        for cls in ast.walk(tree)
        if isinstance(cls, ast.ClassDef) and any(_last(base) in NODES for base in cls.bases)
        for node in ast.walk(cls)
    }
    functions = {
        id(node): function
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
        for node in ast.walk(function)
    }
    imported = _imported(tree)
    for call in walk(tree):
        if isinstance(call, ast.Call):
            cls = within.get(id(call))
            for value in _names(call, cls, imported):
                name = _text(value, functions.get(id(call)), cls, tree)
                if name:
                    return name
    return ""


def _imported(tree: ast.Module) -> set[str]:
    """Return the names of the node classes that a file imports from rclpy."""
    return {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "rclpy"
        for alias in node.names
        if alias.name in NODES
    }


def _names(call: ast.Call, cls: ast.ClassDef | None, imported: set[str]) -> list[ast.expr]:
    """Return the arguments that may name a node, if a call creates one."""
    function, args = call.func, call.args
    if cls is not None and isinstance(function, ast.Attribute) and function.attr == "__init__":
        if isinstance(function.value, ast.Call) and _last(function.value.func) == "super":
            pass
        elif _last(function.value) in NODES:  # Node.__init__(self, "name")
            args = args[1:]
        else:
            return []
    elif _last(function) not in NAMING and not (
        (isinstance(function, ast.Name) and function.id in imported)
        or ast.unparse(function) in ("rclpy.node.Node", "rclpy.lifecycle.LifecycleNode")
    ):
        return []
    return [*args[:1], *(one.value for one in call.keywords if one.arg in _KEYWORDS)]


def _text(
    value: ast.expr, function: ast.FunctionDef | None, cls: ast.ClassDef | None, tree: ast.Module
) -> str:
    """Return the text of an argument: a constant, or a variable or parameter that has one constant value."""
    if isinstance(value, ast.Constant):
        return value.value if isinstance(value.value, str) else ""
    if not isinstance(value, ast.Name):
        return ""
    if function is not None:
        parameters = [one.arg for one in function.args.args]
        if value.id in parameters:
            return _parameter(function, parameters.index(value.id), cls, tree)
    values = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign)
        and any(isinstance(one, ast.Name) and one.id == value.id for one in node.targets)
    ]
    return _constant(values)


def _parameter(function: ast.FunctionDef, index: int, cls: ast.ClassDef | None, tree: ast.Module) -> str:
    """Return the text that every call of a class passes for a parameter of `__init__`; if no call does, the default."""
    name = function.args.args[index].arg
    passed = [
        argument
        for call in ast.walk(tree)
        if cls is not None and isinstance(call, ast.Call) and _last(call.func) == cls.name
        for argument in (
            *call.args[index - 1 : index],
            *(one.value for one in call.keywords if one.arg == name),
        )
    ]
    place = index - len(function.args.args) + len(function.args.defaults)
    default = function.args.defaults[place : place + 1] if place >= 0 else []
    return _constant(passed or default)


def _constant(values: list[ast.expr]) -> str:
    texts = {
        one.value if isinstance(one, ast.Constant) and isinstance(one.value, str) else "" for one in values
    }
    return texts.pop() if len(texts) == 1 else ""


def _last(expr: ast.expr) -> str:
    if isinstance(expr, ast.Attribute):
        return expr.attr
    return expr.id if isinstance(expr, ast.Name) else ""
