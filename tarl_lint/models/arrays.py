"""Arrays that a program makes without data, often for a library to fill."""

from __future__ import annotations

from collections.abc import Sequence
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


def computed(
    ctx: Interpreter, expr: ir.Operation, operands: Sequence[Value], deps: Nodes, frame: Frame
) -> Value | None:
    """Return the new array that an arithmetic operator makes of an array; None if no operand is one.

    The result counts as made without data even if the operands hold data, because a library may fill the result as
    well.
    """
    if expr.operator not in ARITHMETIC:
        return None
    array = next(filter(is_array, operands), None)
    if array is None:
        return None
    obj = recency.allocate(ctx, "lib", frame, ("computed", expr.pos))
    obj.name = array.objects[0].name
    if deps:
        ctx.store.put((obj, ANY), Value(deps))
    return pointer(obj)
