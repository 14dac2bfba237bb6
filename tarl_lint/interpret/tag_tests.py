"""Tests of tags in conditions: comparisons of a variable, or of a part of one, with tags or classes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

from tarl_lint.interpret import operators
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import NO_CONSTANTS, Value, const
from tarl_lint.models import sizes

EQUAL: Final = frozenset(["==", "is"])
UNEQUAL: Final = frozenset(["!=", "is not"])
Tags = frozenset[object]  # constants, and members of enumerations


@dataclass(frozen=True)
class Test:
    """The condition that an expression is, or is not, one of some tags or of some classes."""

    expr: ir.Expr
    tags: Tags
    holds: bool
    # whether the expression is compared with all tags; if so, a failed comparison means that the expression is none
    # of them
    exact: bool = True
    classes: Value | None = None


def tests(ctx: Interpreter, test: ir.Expr, frame: Frame, *, holds: bool) -> Iterator[Test]:
    """Yield the tests of tags that certainly hold if a condition holds, or certainly fail if it fails."""
    if isinstance(test, ir.Call):
        yield from _of_class(ctx, test, frame, holds=holds)
    if not isinstance(test, ir.Operation):
        return
    parts = test.parts
    if test.operator == "not":
        yield from tests(ctx, parts[0], frame, holds=not holds)
    elif test.operator == ("and" if holds else "or"):
        for part in parts:
            yield from tests(ctx, part, frame, holds=holds)
    elif test.operator == ("or" if holds else "and"):
        yield from _alternatives([list(tests(ctx, part, frame, holds=holds)) for part in parts])
    elif test.operator in EQUAL | UNEQUAL and len(parts) == 2:
        yield from _equal(ctx, parts[0], parts[1], frame, holds=holds is (test.operator in EQUAL))
    elif test.operator in operators.MEMBER and len(parts) == 2 and _names(parts[0]):
        tags = [tags_of(one) for one in sizes.unpacked(ctx, _evaluate(ctx, parts[1], frame)) or ()]
        if tags and all(tags):
            known = frozenset[object]().union(*(one for one in tags if one))
            exact = all(len(one or ()) == 1 for one in tags)
            yield Test(parts[0], known, holds is (test.operator == "in"), exact)


def _alternatives(ways: list[list[Test]]) -> Iterator[Test]:
    """Yield the test that one of several alternatives makes, if all alternatives compare the same expression."""
    if all(len(way) == 1 and way[0].holds and way[0].classes is None for way in ways):
        first = ways[0][0]
        if all(_same(way[0].expr, first.expr) for way in ways):
            yield replace(first, tags=frozenset[object]().union(*(way[0].tags for way in ways)))


def _equal(ctx: Interpreter, first: ir.Expr, second: ir.Expr, frame: Frame, *, holds: bool) -> Iterator[Test]:
    for expr, other in ((first, second), (second, first)):
        if _names(expr) and isinstance(other, (ir.Const, ir.Name, ir.Attribute)):
            tags = tags_of(_evaluate(ctx, other, frame))
            if tags:
                yield Test(expr, tags, holds, len(tags) == 1)
                return


def _of_class(ctx: Interpreter, call: ir.Call, frame: Frame, *, holds: bool) -> Iterator[Test]:
    name = call.function
    if isinstance(name, ir.Name) and name.name == "isinstance" and len(call.arguments) == 2:
        if not isinstance(call.arguments[0], ir.Name):
            return
        asked = _evaluate(ctx, call.arguments[1], frame)
        classes = frozenset(o for one in sizes.unpacked(ctx, asked) or [asked] for o in one.pts)
        if classes and all(o.kind in ("class", "ext") for o in classes):
            yield Test(call.arguments[0], frozenset(), holds, classes=Value(pts=classes))


def _names(expr: ir.Expr) -> bool:
    """Return whether an expression may be a tag: a variable, or an entry or attribute of a variable."""
    return isinstance(expr, ir.Name) or of_variable(expr) is not None


def of_variable(expr: ir.Expr) -> tuple[ir.Name, str | Value] | None:
    """Return the variable in `x.name`, `x[0]` or `x.get("key")`, and the attribute or index."""
    if isinstance(expr, ir.Attribute) and isinstance(expr.base, ir.Name):
        return expr.base, expr.name
    if isinstance(expr, ir.Item) and isinstance(expr.base, ir.Name) and isinstance(expr.index, ir.Const):
        return expr.base, const(expr.index.value)
    if isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and expr.function.name == "get":
        base, given = expr.function.base, expr.arguments
        if isinstance(base, ir.Name) and len(given) == 1 and isinstance(given[0], ir.Const):
            return base, const(given[0].value)
    return None


def _same(first: ir.Expr, second: ir.Expr) -> bool:
    if isinstance(first, ir.Name) and isinstance(second, ir.Name):
        return (first.name, first.scope, first.level) == (second.name, second.scope, second.level)
    one, other = of_variable(first), of_variable(second)
    return one is not None and other is not None and _same(one[0], other[0]) and one[1] == other[1]


def _evaluate(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Value:
    """Evaluate an expression without calls: a constant, a name, an attribute of names, or a display of these."""
    plain = isinstance(expr, (ir.Const, ir.Name))
    if isinstance(expr, ir.Attribute):
        plain = isinstance(expr.base, (ir.Name, ir.Attribute))
    if isinstance(expr, ir.SequenceDisplay):
        plain = all(isinstance(part, (ir.Const, ir.Name, ir.Attribute)) for part in expr.items)
    return ctx.ops.evaluate(ctx, expr, frame) if plain else Value()


def tags_of(value: Value) -> Tags | None:
    """Return the tags that a value may be; None if it may be anything else."""
    if value.pts:
        known = value.consts == NO_CONSTANTS and all(map(enumerations.is_member, value.pts))
        return frozenset(value.pts) if known else None
    keys = value.keys()
    # None is no tag: nullness.py handles tests whether a value is set
    return keys if keys and None not in keys else None


def calls_nothing(test: ir.Expr) -> bool:
    """Return whether a condition contains no calls except those of `isinstance` and of a variable's `get`."""
    if isinstance(test, ir.Call):
        named = isinstance(test.function, ir.Name) and test.function.name == "isinstance"
        return named or of_variable(test) is not None
    if isinstance(test, ir.Operation):
        return all(map(calls_nothing, test.parts))
    if isinstance(test, (ir.Attribute, ir.Item)):
        return calls_nothing(test.base)
    return isinstance(test, (ir.Const, ir.Name, ir.SequenceDisplay))
