"""Functions of an interpreted file: the values of their parameters, and the effect of decorators."""

from __future__ import annotations

import ast
import dataclasses
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.python.evaluation import Evaluation, call_of
from tarl_lint.workspace.python.objects import Class, Function, Method
from tarl_lint.workspace.python.values import Bound, Library, Partial, Scope, Unknown

# decorators that change how a function of a class is called
_KINDS: Final = {
    "staticmethod": "staticmethod", "classmethod": "classmethod", "property": "property",
    "functools.cached_property": "cached_property", "abc.abstractproperty": "property",
    "contextlib.contextmanager": "contextmanager",
}  # fmt: skip


def made_function(run: Evaluation, node: ast.FunctionDef, names: Scope, file: Path, enter: Any) -> Function:
    """Return the function of a definition; `enter` interprets its calls."""
    spec = node.args
    positional = [*spec.posonlyargs, *spec.args]
    last = positional[len(positional) - len(spec.defaults) :]
    pairs = [*zip(last, spec.defaults, strict=True), *zip(spec.kwonlyargs, spec.kw_defaults, strict=True)]
    defaults = {one.arg: run.value(default, names) for one, default in pairs if default is not None}
    return Function(node, names.seen(), defaults, file, enter)


def lambda_of(node: ast.Lambda) -> ast.FunctionDef:
    """Return the function that a `lambda` defines."""
    body: list[ast.stmt] = [ast.copy_location(ast.Return(node.body), node.body)]
    made = ast.FunctionDef(name="lambda", args=node.args, body=body, decorator_list=[])
    return ast.copy_location(made, node)


def arguments(function: Function, args: list[Any], keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the names in the scope of a function when it is called."""
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


def decorated(run: Evaluation, function: Function, names: Scope) -> Any:
    """Apply the known decorators of a function."""
    made: Any = function
    for node in reversed(function.node.decorator_list):
        if isinstance(node, ast.Attribute) and node.attr in ("setter", "deleter", "getter"):
            before = names.find(node.value.id) if isinstance(node.value, ast.Name) else None
            if before is not None and isinstance(before[0], Function):
                made = dataclasses.replace(before[0], setter=made) if node.attr == "setter" else before[0]
            continue
        name = _name_of(node, names)
        if name in _KINDS and isinstance(made, Function):
            made = dataclasses.replace(made, kind=_KINDS[name])
            continue
        decorator = run.value(node, names)
        if isinstance(decorator, Function | Method | Class | Partial | Bound):
            made = run.call(decorator, [made], {}, call_of("a decorator", node.lineno))
    return made


def _name_of(node: ast.expr, names: Scope) -> str:
    """Return the full name of a decorator of the standard library; "" if it is not one."""
    if isinstance(node, ast.Name):
        found = names.find(node.id)
        if found is None:
            return node.id
        return found[0].name if isinstance(found[0], Library) else ""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        found = names.find(node.value.id)
        return f"{found[0].name}.{node.attr}" if found is not None and isinstance(found[0], Library) else ""
    return ""
