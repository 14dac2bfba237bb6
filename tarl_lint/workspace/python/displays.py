"""Evaluate displays and comprehensions of lists, tuples, sets and dicts, and f-strings."""

from __future__ import annotations

import ast
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

from tarl_lint.workspace.python.assignment_targets import bind
from tarl_lint.workspace.python.elements import Unique, items, settled
from tarl_lint.workspace.python.evaluation import Evaluation, unknown
from tarl_lint.workspace.python.operators import formatted
from tarl_lint.workspace.python.values import Library, OpaqueError, Scope, Several, Stream, Unknown


def elements(run: Evaluation, nodes: list[ast.expr], names: Scope) -> list[Any]:
    """Return the values of several expressions, some of which may be starred."""
    found: list[Any] = []
    for node in nodes:
        if isinstance(node, ast.Starred):
            inner = items(run.value(node.value, names))
            found += inner if inner is not None else [Several(node.lineno, unknown(node.value).text)]
            run.spend(len(inner or ()))
        else:
            found.append(run.value(node, names))
    return found


def key_of(value: Any) -> Any:
    """Return a value as the key of a dict; Unknown if it cannot be one."""
    if isinstance(value, list | dict | tuple) and not settled(value, 100):
        return Unknown(0, "a key")
    return value


def _list(run: Evaluation, node: ast.List, names: Scope) -> Any:
    return elements(run, node.elts, names)


def _tuple(run: Evaluation, node: ast.Tuple, names: Scope) -> Any:
    return tuple(elements(run, node.elts, names))


def _set(run: Evaluation, node: ast.Set, names: Scope) -> Any:
    return Unique(elements(run, node.elts, names))


def _dict(run: Evaluation, node: ast.Dict, names: Scope) -> Any:
    found: dict[Any, Any] = {}
    for key, item in zip(node.keys, node.values, strict=True):
        value = run.value(item, names)
        if key is None:
            more = value if isinstance(value, dict | ChainMap) else {}
            found.update(more)
            run.spend(len(more))
        else:
            found[key_of(run.value(key, names))] = value
    return found


def _joined(run: Evaluation, node: ast.JoinedStr, names: Scope) -> Any:
    parts = []
    for one in node.values:
        if isinstance(one, ast.FormattedValue):
            spec = run.value(one.format_spec, names) if one.format_spec is not None else ""
            if not isinstance(spec, str):
                raise OpaqueError("not a constant")
            parts.append(formatted(run.value(one.value, names), spec, one.conversion))
        else:
            parts.append(str(run.value(one, names)))
    run.spend(sum(map(len, parts)) // 50)
    return "".join(parts)


def _list_of(run: Evaluation, node: ast.ListComp, names: Scope) -> Any:
    return [run.value(node.elt, inner) for inner in _loops(run, node.generators, names)]


def _generator(run: Evaluation, node: ast.GeneratorExp, names: Scope) -> Any:
    first = run.value(node.generators[0].iter, names)
    values = (run.value(node.elt, inner) for inner in _loops(run, node.generators, names, first))
    if not isinstance(first, Stream) and items(first) is None:
        raise OpaqueError("unknown elements")
    return Stream(values, endless=isinstance(first, Stream) and first.endless)


def _set_of(run: Evaluation, node: ast.SetComp, names: Scope) -> Any:
    return Unique([run.value(node.elt, inner) for inner in _loops(run, node.generators, names)])


def _dict_of(run: Evaluation, node: ast.DictComp, names: Scope) -> Any:
    return {
        key_of(run.value(node.key, inner)): run.value(node.value, inner)
        for inner in _loops(run, node.generators, names)
    }


def _loops(
    run: Evaluation, loops: list[ast.comprehension], names: Scope, values: Any = None
) -> Iterator[Scope]:
    """Yield the names inside a comprehension. Raises OpaqueError if a list or a condition is not constant."""
    loop, *rest = loops
    values = run.value(loop.iter, names) if values is None else values
    whole = values.values if isinstance(values, Stream) and values.endless else items(values)
    if whole is None:
        raise OpaqueError("unknown elements")
    for item in whole:
        run.spend()
        inner = Scope({}, names, inner=True)
        bind(run, loop.target, item, inner)
        holds = True
        for test in loop.ifs:
            found = run.value(test, inner)
            if isinstance(found, Unknown | Library):
                raise OpaqueError("unknown test")
            if not found:
                holds = False
                break
        if holds:
            yield from _loops(run, rest, inner) if rest else (inner,)


DISPLAYS: Final[Mapping[type[ast.expr], Callable[[Any, Any, Scope], Any]]] = {
    ast.List: _list, ast.Tuple: _tuple, ast.Set: _set, ast.Dict: _dict, ast.JoinedStr: _joined,
    ast.ListComp: _list_of, ast.GeneratorExp: _generator, ast.SetComp: _set_of, ast.DictComp: _dict_of,
}  # fmt: skip
