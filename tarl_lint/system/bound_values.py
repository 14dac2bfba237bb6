"""The expressions that a module binds to a name, and the parts of which a value is made."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from tarl_lint.trees import last_name

Function = ast.FunctionDef | ast.AsyncFunctionDef


def is_empty(expr: ast.expr) -> bool:
    """Return whether a value is an empty table, list or tuple, which a derived class replaces."""
    match expr:
        case ast.Dict(keys=[]) | ast.List(elts=[]) | ast.Tuple(elts=[]):
            return True
    return False


def parts(expr: ast.expr) -> list[ast.expr]:
    """Return the parts of which the strings of an expression are made; empty if these are unknown."""
    match expr:
        case ast.Subscript(value=value):
            return [value]
        case ast.Dict(keys=keys, values=values):
            return [one or spread for one, spread in zip(keys, values, strict=True)]
        case (
            ast.ListComp(elt=made)
            | ast.SetComp(elt=made)
            | ast.GeneratorExp(elt=made)
            | ast.DictComp(key=made)
        ):
            return [made]
        case ast.IfExp(body=body, orelse=otherwise):
            return [body, otherwise]
        case ast.JoinedStr() | ast.BinOp() | ast.BoolOp() | ast.FormattedValue() | ast.Starred():
            return [one for one in ast.iter_child_nodes(expr) if isinstance(one, ast.expr)]
    return []


def parameters(function: Function | ast.Lambda) -> list[str]:
    """Return the names of a function's parameters, except `*args` and `**kwargs`."""
    args = function.args
    return [one.arg for one in (*args.posonlyargs, *args.args, *args.kwonlyargs)]


def binds(function: Function | ast.Lambda, name: str) -> bool:
    """Return whether a name is local to a function: as a parameter, or because the body assigns it."""
    if name in parameters(function):
        return True
    return any(
        isinstance(one, ast.Name) and one.id == name and isinstance(one.ctx, ast.Store)
        for one in ast.walk(function)
    )


def bound_values(inside: ast.AST, name: str, texts: Collection[str]) -> Iterator[ast.expr | None]:
    """Yield the values that statements bind to a name: assigned values and iterables of loops; None if unknown.

    `texts` are the names of variables that hold a single text.
    """
    for node in ast.walk(inside):
        match node:
            case ast.Assign(targets=targets, value=value) if any(_names(one, name) for one in targets):
                yield value
            case ast.AnnAssign(target=target, value=value) | ast.AugAssign(target=target, value=value) if (
                _names(target, name)
            ):
                yield value
            case ast.NamedExpr(target=target, value=value) if _names(target, name):
                yield value
            case ast.For(target=target, iter=over) | ast.comprehension(target=target, iter=over) if _names(
                target, name
            ):
                # a loop over a text yields letters, which are no strings of the program
                yield None if last_name(over) in texts else over
            case ast.withitem(optional_vars=target) if target is not None and _names(target, name):
                yield None


def _names(target: ast.expr, name: str) -> bool:
    """Return whether a target binds the name itself; `name[0] = 1` does not."""
    if isinstance(target, ast.Tuple | ast.List):
        return any(_names(one, name) for one in target.elts)
    if isinstance(target, ast.Starred):
        return _names(target.value, name)
    return isinstance(target, ast.Name) and target.id == name
