"""Find the code that runs first in a block, and the parameters of functions."""

from __future__ import annotations

import ast

from pytest_tarl.instrumentation.forms import Where, start_of

Function = ast.FunctionDef | ast.AsyncFunctionDef


def first_evaluated_in(body: list[ast.stmt]) -> ast.expr | ast.stmt:
    """Return the first node that runs in the body of a branch or loop."""
    return _first_part(next((statement for statement in body if not _is_declaration(statement)), body[0]))


def entry_of(node: Function) -> Where:
    """Return the first node that runs in a function's body; if nothing in it runs, the function itself."""
    at = _entry(node)
    return start_of(_first_part(node.body[at]) if at < len(node.body) else node)


def enter(node: Function | ast.ClassDef, statement: ast.stmt) -> None:
    """Insert a statement at the entry of a function or class, after its docstring and declarations."""
    node.body.insert(_entry(node), statement)


def parameters(arguments: ast.arguments) -> list[ast.arg]:
    """Return all parameters of a function."""
    extra = [one for one in (arguments.vararg, arguments.kwarg) if one is not None]
    return [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs, *extra]


def message_parameter(node: Function, *, in_class: bool) -> str | None:
    """Return the name of the parameter that receives the message: the first one except `self` or `cls`."""
    static = any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in node.decorator_list)
    positional = [parameter.arg for parameter in (*node.args.posonlyargs, *node.args.args)]
    named = positional[1:] if in_class and not static else positional
    rest = [one.arg for one in (node.args.vararg, *node.args.kwonlyargs) if one is not None]
    return next(iter([*named, *rest]), None)


def _entry(node: Function | ast.ClassDef) -> int:
    start = 1 if ast.get_docstring(node, clean=False) is not None else 0
    running = (i for i, inner in enumerate(node.body) if i >= start and not _is_declaration(inner))
    return next(running, len(node.body))


def _first_part(node: ast.stmt) -> ast.expr | ast.stmt:
    decorators: list[ast.expr] = getattr(node, "decorator_list", [])
    for part in (*decorators, *(getattr(node, name, None) for name in ("value", "test", "iter"))):
        if isinstance(part, ast.expr):
            return part
    return node


def _is_declaration(node: ast.stmt) -> bool:
    """Return whether a statement runs no code: global, nonlocal, or an annotation without a value."""
    bare = isinstance(node, ast.AnnAssign) and node.value is None
    return bare or isinstance(node, (ast.Global, ast.Nonlocal))
