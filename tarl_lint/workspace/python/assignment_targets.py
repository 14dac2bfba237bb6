"""Bind values to targets: names, attributes, elements and several of them; delete targets."""

from __future__ import annotations

import ast
from collections import ChainMap, deque
from typing import Any

from tarl_lint.workspace.python.elements import elements_if_known, items, settled
from tarl_lint.workspace.python.evaluation import Evaluation, call_of, unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.objects import Class, Function, Method
from tarl_lint.workspace.python.values import Scope, Stream


def bind(run: Evaluation, target: ast.expr, value: Any, names: Scope) -> None:
    """Assign a value to a name, an element, an attribute, or several of them."""
    if isinstance(target, ast.Name):
        names.store(target.id, value)
    elif isinstance(target, ast.Tuple | ast.List):
        _unpack(run, target, _taken(value, target), names)
    elif isinstance(target, ast.Subscript):
        _store(run, run.value(target.value, names), target.slice, value, names)
    elif isinstance(target, ast.Attribute):
        set_attribute(run, run.value(target.value, names), target.attr, value)


def _taken(value: Any, target: ast.Tuple | ast.List) -> list[Any] | None:
    """Return the elements of an unpacked value; an endless iterator gives one per target."""
    if isinstance(value, Stream) and value.endless:
        return [next(value.values, unknown(target)) for _ in target.elts]
    return elements_if_known(value)


def _unpack(run: Evaluation, target: ast.Tuple | ast.List, values: list[Any] | None, names: Scope) -> None:
    starred = next((i for i, one in enumerate(target.elts) if isinstance(one, ast.Starred)), None)
    wanted = len(target.elts)
    if values is not None and starred is not None and len(values) >= wanted - 1:
        end = len(values) - (wanted - starred - 1)
        values = [*values[:starred], values[starred:end], *values[end:]]
    if values is None or len(values) != wanted:
        if values is not None and run.trying:
            raise ValueError("a wrong number of values to unpack")
        values = [unknown(target)] * wanted
    for one, item in zip(target.elts, values, strict=True):
        bind(run, one.value if isinstance(one, ast.Starred) else one, item, names)


def _store(run: Evaluation, base: Any, index: ast.expr, value: Any, names: Scope) -> None:
    if isinstance(base, list) and isinstance(index, ast.Slice):
        parts = [
            None if one is None else run.value(one, names) for one in (index.lower, index.upper, index.step)
        ]
        more = items(value)
        base[slice(*parts)] = [unknown(index)] if more is None else more
        return
    key = run.value(index, names)
    if isinstance(base, Made) and base.has("__setitem__"):
        base.run("__setitem__", key, value)
        return
    base = base.held if isinstance(base, Made) else base
    if (isinstance(base, dict | ChainMap) and settled(key, 100)) or (
        isinstance(base, list | deque) and isinstance(key, int)
    ):
        base[key] = run.kept(base, value)


def set_attribute(run: Evaluation, base: Any, name: str, value: Any) -> None:
    """Set an attribute of an object or class of the file; call the setter of a property."""
    if isinstance(base, Made):
        found = base.kind.find(name)
        if found is not None and isinstance(found[0], Function) and found[0].setter is not None:
            setter = Method(found[0].setter, base, found[1])
            run.call(setter, [value], {}, call_of(name, found[0].node.lineno))
        else:
            base.attributes[name] = value
    elif isinstance(base, Class):
        base.names[name] = value


def delete(run: Evaluation, target: ast.expr, names: Scope) -> None:
    """Delete a name, an element or an attribute."""
    if isinstance(target, ast.Tuple | ast.List):
        for one in target.elts:
            delete(run, one, names)
    elif isinstance(target, ast.Name):
        names.elsewhere.get(target.id, names).names.pop(target.id, None)
    elif isinstance(target, ast.Attribute):
        base = run.value(target.value, names)
        if isinstance(base, Made):
            base.attributes.pop(target.attr, None)
    elif isinstance(target, ast.Subscript):
        _remove(run, run.value(target.value, names), target.slice, names)


def _remove(run: Evaluation, base: Any, index: ast.expr, names: Scope) -> None:
    if isinstance(base, list) and isinstance(index, ast.Slice):
        parts = [
            None if one is None else run.value(one, names) for one in (index.lower, index.upper, index.step)
        ]
        del base[slice(*parts)]
        return
    key = run.value(index, names)
    if isinstance(base, Made) and base.has("__delitem__"):
        base.run("__delitem__", key)
    elif isinstance(base, dict | ChainMap) and settled(key, 100):
        base.pop(key, None)
    elif isinstance(base, list | deque) and isinstance(key, int) and -len(base) <= key < len(base):
        del base[key]


def read_target(target: ast.expr) -> ast.expr:
    """Return the target of an assignment as an expression that reads it."""
    return ast.copy_location(ast.parse(ast.unparse(target), mode="eval").body, target)
