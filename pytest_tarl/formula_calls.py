"""Find calls of `observe` and `require` in the source of a test's modules, without running them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from pytest_tarl.formulas.said import NOTHING_SAID, Said
from pytest_tarl.modules_of_tests import modules

CALLS = (b".observe(", b".require(")


def said(test: str, root: Path) -> Said:
    """Return the signals and formulas in a test's modules, except in other tests of its file; `test` is a node ID."""
    name, *parts = test.partition("[")[0].split("::")
    first = (root / name).resolve()
    try:
        if not any(call in first.read_bytes() for call in CALLS):
            return NOTHING_SAID
    except OSError:
        return NOTHING_SAID
    calls = [
        call
        for path, tree in modules(first, root)
        for call in _calls(tree, {*parts} if path == first else None)
    ]
    observing = [call for name, call in calls if name == "observe"]
    requiring = [call for name, call in calls if name == "require"]
    words = [word for call in observing for word in call.keywords]
    return Said(
        observed=tuple(dict.fromkeys(name for word in words for name in _names(word))),
        texts=tuple(text for call in requiring for text in _texts(call)),
        computed=any(word.arg is None and _keys(word.value) is None for word in words),
        requires=bool(requiring),
    )


def _calls(tree: ast.AST, test: set[str] | None) -> Iterator[tuple[str, ast.Call]]:
    """Yield the method calls in a tree; if `test` is given, skip tests whose function or class is not in it."""
    for node in ast.iter_child_nodes(tree):
        named = node.name if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)) else ""
        if test is not None and named.lower().startswith("test") and named not in test:
            continue
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            yield node.func.attr, node
        yield from _calls(node, test)


def _names(word: ast.keyword) -> list[str]:
    return [word.arg] if word.arg is not None else _keys(word.value) or []


def _keys(value: ast.expr) -> list[str] | None:
    """Return the keys of a dictionary literal; None if a key is not a constant."""
    if not isinstance(value, ast.Dict):
        return None
    keys = [one.value for one in value.keys if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return keys if len(keys) == len(value.keys) else None


def _texts(call: ast.Call) -> Iterator[str]:
    for given in (*call.args, *(word.value for word in call.keywords)):
        if isinstance(given, ast.Constant) and isinstance(given.value, str):
            yield given.value
