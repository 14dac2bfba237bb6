"""Nullness: distinguish None that means "no message yet" from a None computed from data."""

from __future__ import annotations

from collections.abc import Iterator

from tarl_lint import catalog
from tarl_lint.interpret.interpreter import NONE_ONLY, Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, item_field
from tarl_lint.memory.values import Key, Nodes, Obj, Value, lineage

RETURNED = "<return>"  # pseudo-variable that stands for a function's result
# kinds of expressions that may copy the value of a variable
COPIED = (ir.Name, ir.Attribute, ir.Item, ir.Call)


def only_presence(ctx: Interpreter, expr: ir.Operation, frame: Frame) -> Nodes | None:
    """Return the nodes that decide `x is None` if the test is only about that, else None.

    Whether a message has arrived does not count as data, but the conditions under which it was stored do.
    """
    first, second = expr.parts
    if not isinstance(second, ir.Const) or second.value is not None:
        return None
    return _absence(ctx, first, frame)


def _absence(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Nodes | None:
    """Return the nodes that decide whether a value is set; None if data may decide this."""
    if isinstance(expr, ir.Call):
        ctx.store.reads.ask(ctx.nullness.of_result, expr)
        if expr in ctx.nullness.came_out:
            return None if expr in ctx.nullness.doubtful else frozenset(ctx.nullness.came_out[expr])
    keys = list(_keys(ctx, expr, frame))
    for key in keys:
        ctx.store.reads.ask(ctx.nullness.of_key, key)
    if any(k in ctx.nullness.optional for k in keys):
        return None
    if isinstance(expr, (ir.Item, ir.Call)):
        known = bool(keys) and not _index_chosen(ctx, expr, frame)
    else:
        known = any(k in ctx.nullness.vacant for k in keys)
    return frozenset(n for k in keys for n in ctx.nullness.came.get(k, ())) if known else None


def note_absence(ctx: Interpreter, target: ir.Expr, source: ir.Expr, value: Value, frame: Frame) -> None:
    """Record that a target gets None, or a value that may be None."""
    if value.consts == NONE_ONLY and not value.pts:
        ctx.nullness.vacant.update(_keys(ctx, target, frame))
    elif _holds_data(ctx, value) and (decides := _absence(ctx, source, frame)) is not None:
        _note_copy(ctx, list(_keys(ctx, target, frame)), value, decides, frame, target.pos)
    elif _may_be_none(ctx, source, frame):
        ctx.nullness.optional.update(_keys(ctx, target, frame))


def note_passed(ctx: Interpreter, key: Key, source: ir.Expr, value: Value, frame: Frame) -> None:
    """Record a variable whose value is None only before the first message."""
    if isinstance(source, COPIED) and _holds_data(ctx, value):
        decides = _absence(ctx, source, frame)
        if decides is not None:
            _note_copy(ctx, [key], value, decides, frame, source.pos)


def note_taken(
    ctx: Interpreter, target: ir.Expr, held: Value, number: int, value: Value, frame: Frame
) -> None:
    """Record a target whose sequence element is None only before the first message."""
    keys = [(o, item_field(number)) for o in held.pts if o.kind == "sequence"]
    for key in keys:
        ctx.store.reads.ask(ctx.nullness.of_key, key)
    if any(k in ctx.nullness.vacant for k in keys):
        decides = frozenset(n for k in keys for n in ctx.nullness.came.get(k, ()))
        _note_copy(ctx, list(_keys(ctx, target, frame)), value, decides, frame, target.pos)


def _note_copy(
    ctx: Interpreter, keys: list[Key], value: Value, decides: Nodes, frame: Frame, pos: ir.Pos
) -> None:
    there = ctx.node(frame, ("came", pos), "condition")
    ctx.graph.choice(value.deps, there)
    ctx.graph.flow(decides, there)
    for key in keys:
        ctx.nullness.vacant.add(key)
        ctx.nullness.came.setdefault(key, set()).add(there)


def _holds_data(ctx: Interpreter, value: Value) -> bool:
    if not value.pts:
        return bool(value.deps)
    ctx.look(value.pts)
    return bool(value.deps) or any(o.laden for o in value.pts)


def note_result(ctx: Interpreter, call: ir.Call, returned: list[Value], frame: Frame) -> None:
    """Record a call whose result is None because of data, or is None only before the first message."""
    ctx.store.reads.ask(ctx.nullness.of_key, (frame, RETURNED))
    without = [v.consts == NONE_ONLY and not v.pts for v in returned]
    if any(without) and not all(without):
        ctx.nullness.doubtful.add(call)
    elif (frame, RETURNED) in ctx.nullness.vacant:
        ctx.nullness.came_out.setdefault(call, set()).update(ctx.nullness.came.get((frame, RETURNED), ()))


def _may_be_none(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> bool:
    if isinstance(expr, ir.Call):
        name = expr.function.name if isinstance(expr.function, (ir.Attribute, ir.Name)) else ""
        ctx.store.reads.ask(ctx.nullness.of_result, expr)
        return expr in ctx.nullness.doubtful or name in catalog.MAY_BE_NONE
    if isinstance(expr, ir.Choice):
        return any(_none(arm) or _may_be_none(ctx, arm, frame) for arm in (expr.then, expr.other))
    if isinstance(expr, (ir.Name, ir.Attribute)):
        keys = list(_keys(ctx, expr, frame)) if ctx.nullness.optional else []
        if not keys:
            ctx.store.reads.ask(ctx.nullness.of_key, None)
        for key in keys:
            ctx.store.reads.ask(ctx.nullness.of_key, key)
        return any(k in ctx.nullness.optional for k in keys)
    return False


def _keys(ctx: Interpreter, expr: ir.Expr, frame: Frame) -> Iterator[Key]:
    """Yield a variable's or field's keys; for an instance's field, also those in its classes."""
    if isinstance(expr, ir.Name):
        yield ctx.ops.holder(expr, frame), expr.name
    elif isinstance(expr, ir.Attribute) and isinstance(expr.base, (ir.Name, ir.Attribute, ir.Item)):
        for base in ctx.ops.evaluate(ctx, expr.base, frame).objects:
            for owner in (base, *_classes(base)):
                yield owner, expr.name
    elif isinstance(expr, ir.Item):
        yield from _elements(ctx, expr.base, frame)
    elif isinstance(expr, ir.Call) and isinstance(expr.function, ir.Attribute) and _gets(expr):
        yield from _elements(ctx, expr.function.base, frame)


def _elements(ctx: Interpreter, container: ir.Expr, frame: Frame) -> Iterator[Key]:
    """Yield the keys of the elements of analysed containers; a None in one element counts for all elements."""
    held = (
        ctx.ops.evaluate(ctx, container, frame).pts if isinstance(container, (ir.Name, ir.Attribute)) else ()
    )
    if all(o.kind in ("sequence", "mapping") for o in held):
        for obj in held:
            yield obj, ANY


def _index_chosen(ctx: Interpreter, expr: ir.Item | ir.Call, frame: Frame) -> bool:
    """Return whether the index of an element may depend on data."""
    index = expr.index if isinstance(expr, ir.Item) else expr.arguments[0]
    if not isinstance(index, (ir.Const, ir.Name, ir.Attribute)):
        return True
    key = ctx.ops.evaluate(ctx, index, frame)
    return bool(key.deps or key.pts)


def _classes(obj: Obj) -> list[Obj]:
    return lineage(obj.info) if obj.kind == "instance" and isinstance(obj.info, Obj) else []


def _gets(expr: ir.Call) -> bool:
    return (
        isinstance(expr.function, ir.Attribute) and expr.function.name == "get" and len(expr.arguments) == 1
    )


def _none(expr: ir.Expr) -> bool:
    return isinstance(expr, ir.Const) and expr.value is None
