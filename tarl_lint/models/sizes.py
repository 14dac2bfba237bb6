"""Concatenation, repetition, union and slices of containers; dependencies of their lengths."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory import enumerations, heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, KEYS, LENGTH, SENT, item_field
from tarl_lint.memory.values import (
    ABSENT,
    BOTTOM,
    NO_CONSTANTS,
    NONE,
    UNKNOWN,
    Nodes,
    Obj,
    Value,
    in_order,
    join_all,
    pointer,
)
from tarl_lint.models import equality

MAX_KNOWN = 16  # maximum number of elements tracked separately in a computed sequence
COMBINING = frozenset(["+", "*", "|", "-", "&", "-="])


def combined(ctx: Interpreter, expr: ir.Operation, values: list[Value], frame: Frame) -> Value | None:
    """Return the new container that an operator makes of containers; None if no operand is a container."""
    kinds = [{o.kind for o in v.pts} for v in values]
    if expr.operator == "*" and {"sequence"} in kinds:
        return repeated(ctx, expr, values, frame)
    if kinds == [{"sequence"}, {"sequence"}]:
        return concatenated(ctx, expr, values, frame)
    if kinds == [{"mapping"}, {"mapping"}]:
        obj = recency.allocate(ctx, "mapping", frame, ("combined", expr.pos))
        for value, part in zip(values, expr.parts, strict=True):
            absorb(ctx, obj, value, part)
        return Value(values[0].deps | values[1].deps, frozenset([obj]))
    return None


def repeated(ctx: Interpreter, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
    """Return `[x] * n`."""
    several = next(v for v in values if v.pts)
    count = ctx.use(next((v for v in values if v is not several), UNKNOWN))
    element, longer = heap.elements(ctx, several), length(ctx, several)
    obj = recency.allocate(ctx, "sequence", frame, ("combined", expr.pos))
    updates.add_element(ctx, pointer(obj), element)
    ctx.store.put((obj, LENGTH), Value(longer | count))
    return Value(several.deps, frozenset([obj]))


def concatenated(ctx: Interpreter, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
    """Return `a + b`. Its elements are tracked separately if the elements of both operands are known."""
    if expr.operator.startswith("-"):
        return difference(ctx, expr, values, frame)
    known = [unpacked(ctx, v) for v in values]
    element = join_all(heap.elements(ctx, v) for v in values)
    longer = length(ctx, values[0]) | length(ctx, values[1])
    obj = recency.allocate(ctx, "sequence", frame, ("combined", expr.pos))
    exact = [e for part in known if part is not None for e in part]
    if None in known or len(exact) > MAX_KNOWN or expr.operator != "+":
        updates.add_element(ctx, pointer(obj), element)
    else:
        for number, value in enumerate(exact):
            ctx.store.put((obj, item_field(number)), value)
    ctx.store.put((obj, LENGTH), Value(longer))
    return Value(values[0].deps | values[1].deps, frozenset([obj]))


def difference(ctx: Interpreter, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
    """Return `a - b`: the elements of `a`; comparisons with those of `b` decide which ones, and how many."""
    first, second = (heap.elements(ctx, value) for value in values)
    decides = NONE.union(*(value.deps for value in values), *(length(ctx, value) for value in values))
    decides |= equality.either_decides(ctx, first, second, frame, expr.pos)
    left = ctx.reached(equality.selected(ctx, frame, ("left", expr.pos), decides))
    obj = recency.allocate(ctx, "sequence", frame, ("combined", expr.pos))
    updates.add_element(ctx, pointer(obj), Value(first.deps | left, first.pts, first.consts))
    ctx.store.put((obj, LENGTH), Value(left))
    return Value(values[0].deps, frozenset([obj]))


def grown(ctx: Interpreter, expr: ir.Operation, values: list[Value], frame: Frame) -> Value:
    """Return the container after `a += b` or `a |= b`.

    One node of the statement passes on all elements, and another node passes on the length. All containers share
    these two nodes.
    """
    first, second = values
    tables = frozenset(o for o in first.pts if o.kind == "mapping" and expr.operator == "|=")
    for obj in in_order(tables):
        absorb(ctx, obj, second)
    if others := first.pts - tables:
        news = ctx.carry(heap.elements(ctx, second), ctx.node(frame, ("grown", expr.pos), "assign"))
        updates.add_element(ctx, Value(first.deps, others), news)
        longer = ctx.carry(Value(length(ctx, second)), ctx.node(frame, ("longer", expr.pos), "assign"))
        for obj in in_order(others) if longer.deps else ():
            decide_length(ctx, obj, longer.deps)
    return Value(first.deps | second.deps, first.pts)


def sliced(ctx: Interpreter, base: Value, index: ir.Slice, pos: ir.Pos, frame: Frame) -> Value:
    """Return `base[a:b]`: for a sequence, a new sequence; for other objects, the value of their elements.

    The elements are tracked separately if the elements of the base and the bounds are known.
    """
    bounds = [ctx.ops.evaluate(ctx, part, frame) for part in index.parts]
    extra = NONE
    for bound in bounds:
        extra |= ctx.use(bound)
    ours = frozenset(o for o in base.pts if o.kind == "sequence")
    if not ours or ours != base.pts:
        return ctx.ops.read_item(ctx, base, Value(extra))
    if not extra and (several := _each_sliced(ctx, base, index, bounds, pos, frame)) is not None:
        return several
    element = heap.elements(ctx, Value(pts=ours))
    longer = length(ctx, Value(pts=ours)) | extra
    between = _between(ctx, base, index, bounds)
    obj = recency.allocate(ctx, "sequence", frame, ("slice", pos))
    for number, value in enumerate(between or ()):
        ctx.store.put((obj, item_field(number)), Value(value.deps | extra, value.pts, value.consts))
    if between is not None and ctx.exact:
        return pointer(obj)
    if between is None:
        updates.add_element(ctx, pointer(obj), Value(element.deps | extra, element.pts, element.consts))
    ctx.store.put((obj, LENGTH), Value(longer))
    return Value(base.deps, frozenset([obj]))


def _each_sliced(
    ctx: Interpreter, base: Value, index: ir.Slice, bounds: list[Value], pos: ir.Pos, frame: Frame
) -> Value | None:
    """Return a slice of each of several known sequences; None if one is not known."""
    found: dict[Obj, list[Value]] = {}
    for obj in each_unpacked(ctx, base):
        between = _between(ctx, Value(base.deps, frozenset([obj])), index, bounds)
        if between is None:
            return None
        found[obj] = between
    return rests(ctx, found, frame, pos) if found else None


def _between(ctx: Interpreter, base: Value, index: ir.Slice, bounds: list[Value]) -> list[Value] | None:
    """Return the elements of a slice; None if the base's elements or the bounds are unknown.

    In a known command line, only constants count as known.
    """
    elements = constants(ctx, base) if ctx.exact else unpacked(ctx, base)
    if elements is None or not index.bounds or (len(elements) > MAX_KNOWN and not ctx.exact):
        return None
    given = iter(bounds)
    ends: list[int | None] = []
    for part in index.bounds:
        known, end = next(given).constant() if part is not None else (True, None)
        if not known or not (end is None or isinstance(end, int)):
            return None
        ends.append(end)
    return elements[slice(*ends)] if 0 not in ends[2:] else None


def constants(ctx: Interpreter, value: Value) -> list[Value] | None:
    """Return the elements of a sequence if each element is one known constant, else None."""
    elements = unpacked(ctx, value)
    if elements is None or not all(one.fixed() and one != ABSENT and not one.deps for one in elements):
        return None
    return elements


def unpacked(ctx: Interpreter, value: Value) -> list[Value] | None:
    """Return the elements of a sequence with known elements, or the members of an enumeration."""
    if len(value.pts) != 1:
        return None
    obj = next(iter(value.pts))
    if obj.kind == "class" and (members := enumerations.members(ctx, obj)) is not None:
        return [heap.arrive(ctx, member, value.deps) for _, member in members]
    if obj.kind != "sequence" or heap.content(ctx, obj) is not BOTTOM:
        return None
    found: list[Value] = []
    while (stored := ctx.store.get((obj, item_field(len(found))))) is not None:
        found.append(heap.arrive(ctx, stored, value.deps))
    return found


def each_unpacked(ctx: Interpreter, value: Value, least: int = 0) -> dict[Obj, list[Value]]:
    """Return the known elements of each sequence; empty if one is unknown or shorter than `least`."""
    if not 1 < len(value.pts) <= MAX_KNOWN or any(o.kind != "sequence" for o in value.pts):
        return {}
    found = {obj: unpacked(ctx, Value(value.deps, frozenset([obj]))) for obj in value.objects}
    known = {obj: way for obj, way in found.items() if way is not None and least <= len(way) <= MAX_KNOWN}
    return known if len(known) == len(found) else {}


def rests(ctx: Interpreter, parts: Mapping[Obj, Sequence[Value]], frame: Frame, slot: Hashable) -> Value:
    """Return a new sequence for each of several sequences, with some of its elements.

    `info` of the new sequence is the one that has all elements.
    """
    made: list[Obj] = []
    for source, elements in parts.items():
        obj = recency.allocate(ctx, "sequence", frame, ("rest", slot, source.number))
        obj.describe(source)
        for number, value in enumerate(elements):
            ctx.store.put((obj, item_field(number)), value)
        made.append(obj)
    return Value(pts=frozenset(made), consts=NO_CONSTANTS)


def counted(ctx: Interpreter, source: ir.Expr, frame: Frame, *, each: bool) -> Value:
    """Evaluate a loop's object; with `each`, numbers of a `range` and lengths are known."""
    outside, ctx.counting = ctx.counting, frame.statement if each else ctx.counting
    value = ctx.ops.evaluate(ctx, source, frame)
    ctx.counting = outside
    return value


def counts(ctx: Interpreter, frame: Frame) -> bool:
    """Return whether numbers are followed one by one in the current statement."""
    return ctx.exact or (ctx.counting is not None and frame.statement is ctx.counting)


def is_empty(ctx: Interpreter, value: Value) -> bool:
    """Return whether a value is a list or tuple without elements."""
    return not value.deps and unpacked(ctx, value) == [] and length(ctx, value) == NONE


def absorb(ctx: Interpreter, obj: Obj, value: Value, expr: ir.Expr | None = None) -> None:
    """Copy the elements of all objects of a value into an object.

    If `expr` is a dict literal, each of its constant keys is certainly present, so the value of the key replaces
    the previous value.
    """
    certain = frozenset[str]()
    if isinstance(expr, ir.MappingDisplay) and len(value.pts) == 1 and recency.single(ctx, obj):
        texts = (key.value for key, _ in expr.items if isinstance(key, ir.Const))
        certain = frozenset(item_field(text) for text in texts)
    for source in value.objects:
        ctx.store.look(source)
        attributes = source.kind == "instance" and heap.items_are_attributes(source)
        for name in list(source.fields):
            stored = ctx.store.get((source, name))
            if stored is not None and attributes and name.isidentifier():
                # `vars(source)` is represented by the object itself
                updates.weaken(
                    ctx, obj, heap.attribute_of_item(obj, name), heap.arrive(ctx, stored, value.deps)
                )
            elif stored is not None and (name.startswith("[") or name in (ANY, KEYS, LENGTH)):
                field = heap.attribute_of_item(obj, name[2:-2]) if name.startswith("['") else name
                arrived = heap.arrive(ctx, stored, value.deps)
                if name in certain:
                    ctx.store.put((obj, field), arrived)
                elif name == ANY:
                    updates.add_element(ctx, pointer(obj), arrived)
                else:
                    updates.weaken(ctx, obj, field, arrived)
        content = heap.content(ctx, source)
        if content.deps and ctx.store.get((source, ANY)) is None:
            updates.add_element(ctx, pointer(obj), content)
    if not value.pts and value.deps:
        updates.add_element(ctx, pointer(obj), Value(value.deps))


def empty(ctx: Interpreter, obj: Obj) -> None:
    """Remove all elements of a container."""
    ctx.store.reads.look(obj)
    for name in list(obj.fields):
        if name.startswith("[") or name in (ANY, KEYS, LENGTH):
            ctx.store.put((obj, name), ABSENT)


# --- lengths ------------------------------------------------------------------------------------------


def length(ctx: Interpreter, value: Value) -> Nodes:
    """Return the nodes on which a value's length depends. The elements of analysed containers are left out."""
    deps = value.deps
    for obj in value.objects:
        if sized(ctx, obj):
            stored = ctx.store.get((obj, LENGTH))
            made = stored.deps if stored is not None else NONE
            if obj.parent is not None:
                made |= heap.content(ctx, obj.parent).deps
            deps |= ctx.graph.through(made, value.deps)
        elif (shape := heap.shape(ctx, obj)) is not None:
            deps |= shape.deps
        elif SENT in obj.fields:
            deps |= heap.content(ctx, obj).deps
        elif heap.attribute_names(ctx, obj) is None:
            deps |= ctx.use(Value(value.deps, frozenset([obj])))
    return deps


def sized(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an object is a container or array. The data of its elements does not influence its length."""
    if obj.kind in ("sequence", "mapping"):
        return True
    ctx.store.reads.look(obj)
    return obj.parent is not None and (ANY in obj.fields or any(n.startswith("[") for n in obj.subs))


def placed(ctx: Interpreter, objects: frozenset[Obj]) -> Nodes:
    """Return the nodes that added elements to containers; later stores into the elements do not count."""
    found: set[int] = set()
    for obj in objects:
        ctx.store.look(obj)
        found |= heap.content(ctx, obj).deps
        for name in list(obj.fields):
            if name.startswith("[") or name in (KEYS, LENGTH):
                value = ctx.store.get((obj, name))
                found |= value.deps if value is not None else NONE
    return frozenset(found)


def lengthen(ctx: Interpreter, obj: Obj, value: Value) -> None:
    """Make an object's length depend on the length of a value; the object gets the elements of this value."""
    longer = length(ctx, value)
    if longer:
        decide_length(ctx, obj, longer)


def decide_length(ctx: Interpreter, obj: Obj, deps: Nodes) -> None:
    """Add dependencies to an object's length."""
    before = ctx.store.get((obj, LENGTH))
    ctx.store.put((obj, LENGTH), Value(deps | (before.deps if before is not None else NONE)))
