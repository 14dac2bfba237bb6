"""The constant beginning and end of texts that are computed at run time, as in `"on_" + kind` or `f"{kind}_done"`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.ir.control_dependence import every_statement
from tarl_lint.memory.frames import Frame

JOINING: Final = ("+", "text")  # operators whose result consists of all operands in order
_FIELD: Final = re.compile(r"%[^A-Za-z%]*[A-Za-z%]")  # a field of the `%` operator
_BRACES: Final = re.compile(r"\{[^{}]*\}")  # a field of `format`


@dataclass(frozen=True)
class Ends:
    """The known ends of a text; `whole` if these are the same text, and there is nothing between them."""

    start: str = ""
    end: str = ""
    whole: bool = False

    def then(self, other: Ends) -> Ends:
        """Return the ends of this text, followed by another one."""
        start = self.start + other.start if self.whole else self.start
        end = self.end + other.end if other.whole else other.end
        return Ends(start, end, self.whole and other.whole)

    def fit(self, name: str) -> bool:
        """Return whether a name may be this text."""
        longer = len(name) >= len(self.start) + len(self.end)
        return (
            name == self.start
            if self.whole
            else longer and name.startswith(self.start) and name.endswith(self.end)
        )


def ends(ctx: Interpreter, expr: ir.Expr, frame: Frame, followed: frozenset[str] = frozenset()) -> Ends:
    """Return the known ends of a text. A variable that is assigned once in its function is followed.

    `followed` are the variables whose assignment is being followed.
    """
    if isinstance(expr, ir.Const):
        return Ends(expr.value, expr.value, whole=True) if isinstance(expr.value, str) else Ends()
    if isinstance(expr, ir.Name | ir.Attribute):
        return _of_variable(ctx, expr, frame, followed)
    if isinstance(expr, ir.Operation) and expr.operator in JOINING:
        found = Ends(whole=True)
        for part in expr.parts:
            found = found.then(ends(ctx, part, frame, followed))
        return found
    if isinstance(expr, ir.Operation) and expr.operator == "%":
        return _around(_FIELD, ends(ctx, expr.parts[0], frame, followed))
    if (
        isinstance(expr, ir.Call)
        and isinstance(expr.function, ir.Attribute)
        and expr.function.name == "format"
    ):
        return _around(_BRACES, ends(ctx, expr.function.base, frame, followed))
    return Ends()


def _around(fields: re.Pattern[str], text: Ends) -> Ends:
    """Return what is before the first and behind the last field of a text with fields."""
    found = [*fields.finditer(text.start)] if text.whole else []
    return Ends(text.start[: found[0].start()], text.end[found[-1].end() :]) if found else Ends()


def _of_variable(
    ctx: Interpreter, expr: ir.Name | ir.Attribute, frame: Frame, followed: frozenset[str]
) -> Ends:
    known, text = ctx.ops.evaluate(ctx, expr, frame).constant()
    if known and isinstance(text, str):
        return Ends(text, text, whole=True)
    if not isinstance(expr, ir.Name) or expr.level or expr.name in followed:
        return Ends()
    body = frame.function.body or ()
    assigned = [value for name, value in _assignments(body) if name == expr.name]
    if any(parameter.name == expr.name for parameter in frame.function.parameters):
        certain = [s for s in body if isinstance(s, ir.Assign) and s.value in assigned]
        assigned = assigned if len(certain) == len(assigned) else []
    return ends(ctx, assigned[0], frame, followed | {expr.name}) if len(assigned) == 1 else Ends()


def _assignments(body: Sequence[ir.Stmt]) -> Iterator[tuple[str, ir.Expr]]:
    """Yield the variables that statements assign, with the assigned expressions."""
    for s in every_statement(body):
        if isinstance(s, ir.Assign):
            for target in s.targets:
                if isinstance(target, ir.Name):
                    yield target.name, s.value
        elif isinstance(s, ir.Loop) and isinstance(s.target, ir.Name):
            yield s.target.name, ir.Const(None, s.pos)
