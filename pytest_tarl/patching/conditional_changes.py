"""Make a change conditional, with an `if` or a conditional expression."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from pytest_tarl.patching.document import Document, Edit, parse_expression
from pytest_tarl.patching.expression_texts import choice, fitted
from pytest_tarl.patching.vocabulary import free, names

LONGEST_COPY = 3  # a statement of at most this many lines may be written twice, under `if` and `else`
# maximum length of a condition inside an expression; longer ones get a name
LONGEST_CONDITION = 48
_ARITHMETIC = {
    "abs",
    "bool",
    "float",
    "int",
    "len",
    "math",
    "max",
    "min",
    "np",
    "numpy",
    "pow",
    "round",
    "sum",
}
_SIMPLE = (ast.Assign, ast.AugAssign, ast.Expr, ast.Return, ast.Raise, ast.Assert, ast.Delete)
_DIRECTIVES = ("# noqa", "# type:", "# pragma", "# pylint", "# tarl:", "# pyright")


@dataclass(frozen=True)
class Change:
    """A use of a constant, and the code `then` that replaces it while the condition holds.

    If the change is a factor, `factor` and `rest` are the parts of `then`, such as `2.4` and ` * self.kp`.
    """

    node: ast.expr
    then: str
    factor: str = ""
    rest: str = ""


def lazy(source: Document, node: ast.expr) -> ast.expr | None:
    """Return the body of the lambda or generator in which a use runs later, or None."""
    for around in source.ancestors(node):
        if isinstance(around, ast.stmt):
            return None
        if isinstance(around, ast.Lambda):
            return around.body
        if isinstance(around, ast.GeneratorExp) and not _consumed(source, around):
            return around.elt
    return None


def doubled(source: Document, statement: ast.stmt, changes: Sequence[Change]) -> bool:
    """Return whether a statement may be written twice, once for each case."""
    short = (statement.end_lineno or 0) - statement.lineno < LONGEST_COPY
    late = any(lazy(source, change.node) for change in changes)
    plain = isinstance(statement, _SIMPLE) and source.alone(statement)
    return plain and short and not late and not _has_long_text(statement)


def replaced(source: Document, changes: Sequence[Change]) -> list[Edit]:
    """Return the edits that make changes unconditionally."""
    return [
        Edit(*_place(source, change.node), fitted(source, change.node, change.then)) for change in changes
    ]


def inlined(source: Document, change: Change, condition: str) -> Edit:
    """Return the edit that replaces a use by a conditional expression."""
    if change.factor:
        code = f"({choice(condition, change.factor, '1')}){change.rest}"
    else:
        code = choice(condition, change.then, source.source(change.node))
    return Edit(*_place(source, change.node), fitted(source, change.node, code))


def branched(source: Document, group: Sequence[tuple[ast.stmt, Sequence[Change]]], condition: str) -> Edit:
    """Return the edit that writes consecutive statements twice, under `if` and `else`."""
    first, last = group[0][0], group[-1][0]
    indent, unit = source.indentation(first), source.unit
    start, end = source.start(first), source.line_end(last)
    changed = f"\n{indent}".join(_changed(source, statement, changes) for statement, changes in group)
    original = source.text[start:end]
    head = f"if {condition}:\n{indent}{unit}{_deeper(changed, unit)}\n{indent}"
    if len(group) == 1 and isinstance(first, ast.Return | ast.Raise):
        return Edit(start, end, f"{head}{original}")
    return Edit(start, end, f"{head}else:\n{indent}{unit}{_deeper(original, unit)}")


def named(source: Document, statement: ast.stmt, name: str, condition: str) -> Edit:
    """Return the edit that assigns the condition to a name before a statement."""
    start = source.start(statement)
    return Edit(start, start, f"{name} = {condition}\n{source.indentation(statement)}")


def nameable(source: Document, statement: ast.stmt, changes: Sequence[Change]) -> bool:
    """Return whether a condition cannot change its value before the changes are evaluated."""
    once = isinstance(statement, (*_SIMPLE, ast.AnnAssign, ast.If, ast.For, ast.With))
    late = any(lazy(source, change.node) for change in changes)
    return once and not late and source.leads(statement) and not _is_elif(source, statement)


def choices(
    source: Document, statement: ast.stmt, changes: Sequence[Change], tests: Sequence[str]
) -> Iterator[Edit]:
    """Yield edits inside a statement; long conditions are assigned to a name before it."""
    test = tests[0]
    long = len(changes) > 1 or len(test) > LONGEST_CONDITION
    if long and nameable(source, statement, changes):
        asked = {each.id for each in ast.walk(parse_expression(test)) if isinstance(each, ast.Name)}
        name = free("drifted", names(source) | asked)
        yield named(source, statement, name, test)
        tests = [name] * len(changes)
    for change, each in zip(changes, tests, strict=True):
        yield inlined(source, change, each)


def neighbours(
    source: Document, twice: Sequence[tuple[ast.stmt, list[Change], str]]
) -> Iterator[list[tuple[ast.stmt, list[Change], str]]]:
    """Group consecutive statements that have the same condition and do not change its value."""
    group: list[tuple[ast.stmt, list[Change], str]] = []
    for each in twice:
        if group and not _joins(source, group[-1][0], each[0], group[0][2], each[2]):
            yield group
            group = []
        group.append(each)
    if group:
        yield group


def _joins(source: Document, before: ast.stmt, after: ast.stmt, condition: str, other: str) -> bool:
    block = source.block(before)
    follows = any(first is before and second is after for first, second in pairwise(block))
    stored = {
        ast.unparse(node) for node in ast.walk(before) if isinstance(getattr(node, "ctx", None), ast.Store)
    }
    read = {ast.unparse(node) for node in ast.walk(parse_expression(condition)) if isinstance(node, ast.expr)}
    return follows and condition == other and not stored & read and not _calls(before)


def _calls(statement: ast.stmt) -> bool:
    """Return whether a statement may change a condition's value."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Await | ast.Yield | ast.YieldFrom):
            return True
        if isinstance(node, ast.Call) and ast.unparse(node.func).partition(".")[0] not in _ARITHMETIC:
            return True
    return False


def _is_elif(source: Document, statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If) and source.text.startswith("elif", source.start(statement))


def _consumed(source: Document, generator: ast.GeneratorExp) -> bool:
    """Return whether a builtin consumes a generator immediately."""
    call = source.parents[generator]
    eager = {"sum", "min", "max", "any", "all", "list", "tuple", "set", "sorted", "dict"}
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in eager


def _has_long_text(statement: ast.stmt) -> bool:
    """Return whether a statement contains a string of several lines, which indenting would change."""
    texts = (node for node in ast.walk(statement) if isinstance(node, ast.Constant | ast.JoinedStr))
    return any(node.end_lineno != node.lineno for node in texts)


def _place(source: Document, node: ast.expr) -> tuple[int, int]:
    return source.start(node), source.end(node)


def _changed(source: Document, statement: ast.stmt, changes: Sequence[Change]) -> str:
    """Return a statement with its changes, without comments except directives for tools."""
    start, end = source.start(statement), source.end(statement)
    text = source.text[start:end]
    for edit in sorted(replaced(source, changes), key=lambda each: -each.start):
        text = text[: edit.start - start] + edit.text + text[edit.end - start :]
    comment = source.comment(statement)
    return f"{text}  {comment}" if comment.startswith(_DIRECTIVES) else text


def _deeper(text: str, unit: str) -> str:
    """Indent all lines except the first by one more level."""
    first, *others = text.replace("\r\n", "\n").split("\n")
    return "\n".join([first, *(unit + line if line.strip() else line for line in others)])
