"""The patterns of `match` statements."""

from __future__ import annotations

import ast
from collections import ChainMap
from typing import Any, Final

from tarl_lint.workspace.python.builtin_functions import BUILTINS
from tarl_lint.workspace.python.elements import settled
from tarl_lint.workspace.python.evaluator import Evaluator
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.objects import Class
from tarl_lint.workspace.python.values import Library, OpaqueError, Scope, Unknown

_ITSELF: Final = ("str", "int", "float", "bool", "bytes", "list", "tuple", "dict", "set", "frozenset")


def fits(evaluator: Evaluator, pattern: ast.pattern, subject: Any, names: Scope) -> Any:
    """Return whether a subject fits a pattern, and bind the names of the pattern; Unknown if this is not constant."""
    if isinstance(pattern, ast.MatchAs):
        fit = True if pattern.pattern is None else fits(evaluator, pattern.pattern, subject, names)
        if fit is True and pattern.name is not None:
            names.store(pattern.name, subject)
        return fit
    if isinstance(pattern, ast.MatchOr):
        return _any(evaluator, pattern, subject, names)
    if isinstance(subject, Unknown | Library):
        return Unknown(pattern.lineno, "the subject")
    if isinstance(pattern, ast.MatchValue):
        return evaluator.compared(ast.Eq, subject, evaluator.value(pattern.value, names))
    if isinstance(pattern, ast.MatchSingleton):
        return subject is pattern.value
    if isinstance(pattern, ast.MatchSequence):
        return _sequence(evaluator, pattern, subject, names)
    if isinstance(pattern, ast.MatchMapping):
        return _mapping(evaluator, pattern, subject, names)
    if isinstance(pattern, ast.MatchClass):
        return _object(evaluator, pattern, subject, names)
    return Unknown(pattern.lineno, "a pattern")


def _any(evaluator: Evaluator, pattern: ast.MatchOr, subject: Any, names: Scope) -> Any:
    unsure: Any = False
    for one in pattern.patterns:
        fit = fits(evaluator, one, subject, names)
        if fit is True:
            return True
        unsure = unsure or fit
    return unsure


def _all(evaluator: Evaluator, parts: list[tuple[ast.pattern, Any]], names: Scope) -> Any:
    """Return whether all parts fit; the first part that does not fit, or is unknown, determines the result."""
    unsure: Any = True
    for pattern, value in parts:
        fit = fits(evaluator, pattern, value, names)
        if fit is False:
            return False
        unsure = fit if unsure is True else unsure
    return unsure


def _sequence(evaluator: Evaluator, pattern: ast.MatchSequence, subject: Any, names: Scope) -> Any:
    values = subject.plain() if isinstance(subject, Made) else subject
    if not isinstance(values, list | tuple):
        return False
    given = list(values)
    starred = next((i for i, one in enumerate(pattern.patterns) if isinstance(one, ast.MatchStar)), None)
    if starred is None:
        if len(given) != len(pattern.patterns):
            return False
        return _all(evaluator, list(zip(pattern.patterns, given, strict=True)), names)
    after = len(pattern.patterns) - starred - 1
    if len(given) < starred + after:
        return False
    ends = [*given[:starred], *given[len(given) - after :]]
    fixed = [*pattern.patterns[:starred], *pattern.patterns[starred + 1 :]]
    fit = _all(evaluator, list(zip(fixed, ends, strict=True)), names)
    star = pattern.patterns[starred]
    if isinstance(star, ast.MatchStar) and star.name is not None:
        names.store(star.name, given[starred : len(given) - after])
    return fit


def _mapping(evaluator: Evaluator, pattern: ast.MatchMapping, subject: Any, names: Scope) -> Any:
    if not isinstance(subject, dict | ChainMap):
        return False
    keys = [evaluator.value(key, names) for key in pattern.keys]
    if not settled(keys):
        return Unknown(pattern.lineno, "a key")
    if any(key not in subject for key in keys):
        return any(isinstance(key, Unknown) for key in subject) and Unknown(pattern.lineno, "a key")
    fit = _all(
        evaluator, [(one, subject[key]) for one, key in zip(pattern.patterns, keys, strict=True)], names
    )
    if pattern.rest is not None:
        names.store(pattern.rest, {key: value for key, value in subject.items() if key not in keys})
    return fit


def _object(evaluator: Evaluator, pattern: ast.MatchClass, subject: Any, names: Scope) -> Any:
    kind = evaluator.value(pattern.cls, names)
    try:
        if BUILTINS["isinstance"](subject, kind) is False:
            return False
    except OpaqueError:
        return Unknown(pattern.lineno, "a class")
    wanted: list[tuple[ast.pattern, str]] = list(zip(pattern.kwd_patterns, pattern.kwd_attrs, strict=True))
    parts: list[tuple[ast.pattern, Any]] = []
    if pattern.patterns and any(kind is BUILTINS[name] for name in _ITSELF):
        parts.append((pattern.patterns[0], subject))
    elif pattern.patterns:
        stated = _positions(kind)
        if stated is None or len(stated) < len(pattern.patterns):
            return Unknown(pattern.lineno, "a class")
        wanted += list(zip(pattern.patterns, stated, strict=False))
    for one, name in wanted:
        found = evaluator.attribute(subject, name, pattern)
        if found is None:
            return False
        parts.append((one, found[0]))
    return _all(evaluator, parts, names)


def _positions(kind: Any) -> tuple[str, ...] | None:
    """Return the names of the attributes for the positional patterns of a class."""
    if not isinstance(kind, Class):
        return None
    stated = kind.find("__match_args__")
    return tuple(stated[0]) if stated is not None else kind.all_fields()
