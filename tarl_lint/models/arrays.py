"""Arrays that a program makes without data, often for a library to fill."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.values import Nodes, Value, pointer

ARITHMETIC: Final = frozenset(["+", "-", "*", "/", "//", "**"])


def is_array(value: Value) -> bool:
    """Return whether a value is certainly an array that the program made without data."""
    return bool(value.pts) and all(obj.name in catalog.RESERVING for obj in value.pts)


def operate(
    ctx: Interpreter, expr: ir.Operation, values: Iterable[Value], deps: Nodes, frame: Frame
) -> Value | None:
    """Return the new array that an arithmetic operator makes of an array; None if no operand is one."""
    if expr.operator not in ARITHMETIC or not any(map(is_array, values)):
        return None
    obj = recency.allocate(ctx, "lib", frame, ("computed", expr.pos))
    obj.name = next(obj.name for value in values if is_array(value) for obj in value.objects)
    if deps:
        ctx.store.put((obj, ANY), Value(deps))
    return pointer(obj)
