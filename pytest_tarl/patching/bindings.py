"""Bindings of a module: where a name is assigned, and its early values."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from pytest_tarl.patching.document import Document, Function
from pytest_tarl.variables import prefixes

Constant = float | int | bool | str | None
Scope = Function | ast.Lambda


@dataclass(frozen=True, slots=True)
class Binding:
    """A place that assigns `target`: one of `constants`, a new default object (`fresh`), or an unknown value."""

    node: ast.AST
    target: str
    constants: tuple[Constant, ...] = ()
    fresh: bool = False


@cache
def bindings(source: Document) -> tuple[Binding, ...]:
    """Return all bindings of names and attributes in the module."""
    return tuple(found for node in ast.walk(source.tree) for found in _bindings(node))


def scope(source: Document, place: ast.AST, name: str) -> Scope | None:
    """Return the function or lambda in which a name is local, or None."""
    for around in source.ancestors(place):
        if isinstance(around, Scope) and name in local_names(source, around):
            return around
    return None


@cache
def local_names(source: Document, function: Scope) -> frozenset[str]:
    """Return a function's local names, including its parameters."""
    arguments = function.args
    every = [
        *arguments.posonlyargs,
        *arguments.args,
        *arguments.kwonlyargs,
        arguments.vararg,
        arguments.kwarg,
    ]
    names = {each.arg for each in every if each is not None}
    inside = list(ast.walk(function))
    names |= {
        found.target
        for node in inside
        for found in _bindings(node)
        if source.function(found.node) is function
    }
    elsewhere = [node for node in inside if isinstance(node, ast.Global | ast.Nonlocal)]
    own = [node.names for node in elsewhere if source.function(node) is function]
    return frozenset(names.difference(*own))


def is_bound(source: Document, place: ast.AST, code: str) -> bool:
    """Return whether `a.b.c` can be evaluated at a place."""
    chain = prefixes(code)
    read = {ast.unparse(node) for node in _read_at(place)}
    if code in read:
        return True
    if any("[" in prefix and prefix not in read for prefix in chain):
        return False
    return _has_name(source, place, chain[0]) and _has_attribute(source, place, chain)


def initial(source: Document, place: ast.AST, code: str) -> tuple[set[Constant], bool]:
    """Return the constants assigned to `a.b.c`, and whether it is also assigned default objects."""
    local = scope(source, place, code) if code.isidentifier() else None
    constants: set[Constant] = set()
    fresh = False
    for binding in bindings(source):
        here = binding.target == code and (
            not code.isidentifier() or scope(source, binding.node, code) is local
        )
        inherited = _in_class(source, binding.node) and code == f"{code.partition('.')[0]}.{binding.target}"
        if here or inherited:
            constants.update(binding.constants)
            fresh |= binding.fresh
    return constants, fresh


def _read_at(place: ast.AST) -> Iterator[ast.expr]:
    """Yield the names, attributes and items that a statement (or its header) reads."""
    waiting = [place]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript):
            yield node
        waiting += [each for each in ast.iter_child_nodes(node) if isinstance(each, ast.expr | ast.keyword)]


def _has_name(source: Document, place: ast.AST, name: str) -> bool:
    """Return whether a name is local at a place, or assigned when the module is imported."""
    if scope(source, place, name) is not None:
        return True
    return any(each.target == name and source.function(each.node) is None for each in bindings(source))


def _has_attribute(source: Document, place: ast.AST, chain: tuple[str, ...]) -> bool:
    """Return whether an attribute exists from the start; assumed for all objects except `self`."""
    method = source.method(place)
    if method is None or len(chain) < 2 or chain[0] != method[2]:
        return True
    for binding in bindings(source):
        if method[0] in source.ancestors(binding.node):
            function = source.function(binding.node)
            early = function is not None and function.name == "__init__" and binding.target == chain[1]
            if early or (_in_class(source, binding.node) and chain[1] == f"{chain[0]}.{binding.target}"):
                return True
    return False


def _in_class(source: Document, node: ast.AST) -> bool:
    return isinstance(source.parents.get(node), ast.ClassDef)


def _bindings(node: ast.AST) -> Iterator[Binding]:
    if isinstance(node, ast.Assign):
        for target in node.targets:
            yield from _pairs(node, target, node.value)
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        yield from _pairs(node, node.target, node.value)
    elif isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Store):
        yield Binding(node, ast.unparse(node))
    elif isinstance(node, ast.Import | ast.ImportFrom):
        for alias in node.names:
            yield Binding(node, alias.asname or alias.name.partition(".")[0])
    elif isinstance(node, Function | ast.ClassDef):
        yield Binding(node, node.name)


def _pairs(node: ast.stmt, target: ast.expr, value: ast.expr) -> Iterator[Binding]:
    """Yield the bindings of an assignment; tuples of equal length are paired."""
    if isinstance(target, ast.Tuple | ast.List) and isinstance(value, ast.Tuple | ast.List):
        if len(target.elts) == len(value.elts):
            for left, right in zip(target.elts, value.elts, strict=True):
                yield from _pairs(node, left, right)
    else:
        constant = _constant(value)
        fresh = isinstance(value, ast.Call) and not value.args and not value.keywords
        yield Binding(node, ast.unparse(target), constant, fresh)


def _constant(value: ast.expr) -> tuple[Constant, ...]:
    try:
        found = ast.literal_eval(value)
    except ValueError:
        return ()
    return (found,) if found is None or isinstance(found, float | int | bool | str) else ()
