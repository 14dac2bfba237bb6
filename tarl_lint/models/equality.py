"""Equality of objects, and the choice of elements by comparisons."""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret import dunder_methods
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import heap, record_fields
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import NONE, Nodes, Obj, Value, in_order, pointer


def decides(ctx: Interpreter, value: Value, other: Value, frame: Frame, pos: ir.Pos) -> Nodes:
    """Return the data of a value that decides whether it equals another one.

    For an instance of an analysed class, this is the result of its `__eq__`, or its compared fields. Without them, it
    equals only itself, whatever it contains.
    """
    own = frozenset(o for o in value.pts if o.kind == "instance" and isinstance(o.info, Obj))
    found = ctx.use(Value(value.deps, value.pts - own, value.consts))
    for obj in in_order(own):
        found |= _of_instance(ctx, obj, other, frame, pos)
    return found


def either_decides(ctx: Interpreter, one: Value, other: Value, frame: Frame, pos: ir.Pos) -> Nodes:
    """Return the data of two values that decides whether they are equal."""
    return decides(ctx, one, other, frame, pos) | decides(ctx, other, one, frame, pos)


def selected(ctx: Interpreter, frame: Frame, slot: Hashable, decides: Nodes, way: str = "selected") -> int:
    """Return a node of the current statement under one more condition, which depends on `decides`."""
    inner = list(ctx.guards)
    if decides:
        compared = ctx.node(frame, ("compared", slot), "condition")
        ctx.graph.flow(decides, compared)
        inner.append((compared, way))
    return ctx.node(frame, (slot, *inner), "call", conditions=inner)


def _of_instance(ctx: Interpreter, obj: Obj, other: Value, frame: Frame, pos: ir.Pos) -> Nodes:
    said = dunder_methods.special(ctx, pointer(obj), "__eq__", [other], frame, pos)
    if said is not None:
        return ctx.use(said)
    if not isinstance(obj.info, Obj) or record_fields.compared_by_identity(obj.info):
        return NONE
    names = record_fields.compared(ctx, obj.info) or ()
    return NONE.union(*(ctx.use(heap.read_field(ctx, obj, name)) for name in names))
