"""Patterns of `match`: the part of the subject that each name captures."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator

from tarl_lint.ir import nodes as ir

Lower = Callable[[ast.expr], ir.Expr]


def captures(
    pattern: ast.pattern, subject: ir.Expr, where: ir.Pos, lower: Lower
) -> Iterator[tuple[str, ir.Expr]]:
    """Yield each captured name with the expression of its part, outermost first."""
    if isinstance(pattern, ast.MatchAs):
        if pattern.name:
            yield pattern.name, _narrowed(pattern.pattern, subject, where, lower)
        if pattern.pattern is not None:
            yield from captures(pattern.pattern, subject, where, lower)
    elif isinstance(pattern, ast.MatchStar):
        if pattern.name:
            yield pattern.name, subject
    elif isinstance(pattern, ast.MatchOr):
        for alternative in pattern.patterns:
            yield from captures(alternative, subject, where, lower)
    else:
        for inner, part in _parts(pattern, subject, where, lower):
            yield from captures(inner, part, where, lower)
        if isinstance(pattern, ast.MatchMapping) and pattern.rest:
            yield pattern.rest, subject


def _narrowed(pattern: ast.pattern | None, subject: ir.Expr, where: ir.Pos, lower: Lower) -> ir.Expr:
    """Return the subject; if the pattern names a class, as an object of that class."""
    if not isinstance(pattern, ast.MatchClass):
        return subject
    return ir.Operation("as", [subject, lower(pattern.cls)], where)


def conditions(pattern: ast.pattern, subject: ir.Expr, where: ir.Pos, lower: Lower) -> Iterator[ir.Expr]:
    """Yield the conditions under which a pattern matches; no condition if it always matches."""
    if isinstance(pattern, ast.MatchValue):
        yield ir.Operation("==", [subject, lower(pattern.value)], where)
    elif isinstance(pattern, ast.MatchSingleton):
        yield ir.Operation("is", [subject, ir.Const(pattern.value, where)], where)
    elif isinstance(pattern, ast.MatchOr):
        ways = [list(conditions(p, subject, where, lower)) for p in pattern.patterns]
        if all(ways):
            yield ir.Operation("or", [ir.Operation("and", way, where) for way in ways], where)
    elif isinstance(pattern, ast.MatchAs):
        if pattern.pattern is not None:
            yield from conditions(pattern.pattern, subject, where, lower)
    elif not isinstance(pattern, ast.MatchStar):
        yield ir.Operation("type" if isinstance(pattern, ast.MatchClass) else "shape", [subject], where)
        for inner, part in _parts(pattern, subject, where, lower):
            yield from conditions(inner, part, where, lower)


def _parts(
    pattern: ast.pattern, subject: ir.Expr, where: ir.Pos, lower: Lower
) -> Iterator[tuple[ast.pattern, ir.Expr]]:
    """Yield the subpatterns of a pattern with the expressions that they match."""
    if isinstance(pattern, ast.MatchSequence):
        yield from _elements(pattern, subject, where)
    elif isinstance(pattern, ast.MatchMapping):
        for key, inner in zip(pattern.keys, pattern.patterns, strict=True):
            yield inner, ir.Item(subject, lower(key), where)
    elif isinstance(pattern, ast.MatchClass):
        cls = lower(pattern.cls)
        whole = ir.Operation("as", [subject, cls], where)
        for name, inner in zip(pattern.kwd_attrs, pattern.kwd_patterns, strict=True):
            yield inner, ir.Attribute(whole, name, where)
        for number, inner in enumerate(pattern.patterns):
            yield inner, ir.Operation("part", [whole, cls, ir.Const(number, where)], where)


def _elements(
    pattern: ast.MatchSequence, subject: ir.Expr, where: ir.Pos
) -> Iterator[tuple[ast.pattern, ir.Expr]]:
    starred = False
    for number, inner in enumerate(pattern.patterns):
        if isinstance(inner, ast.MatchStar):
            starred = True
            after = len(pattern.patterns) - number - 1
            lower, upper = ir.Const(number, where), ir.Const(-after, where) if after else None
            parts = [lower, upper] if upper is not None else [lower]
            yield inner, ir.Item(subject, ir.Slice(parts, where, (lower, upper)), where)
        else:
            index = number - len(pattern.patterns) if starred else number
            yield inner, ir.Item(subject, ir.Const(index, where), where)
