"""Data reachable inside objects, at any depth."""

from __future__ import annotations

from dataclasses import dataclass, field

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, HOLLOW
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.recency import MAX_NESTING
from tarl_lint.memory.same_reads import unchanged
from tarl_lint.memory.store import Inside
from tarl_lint.memory.values import NONE, ClassInfo, Nodes, Obj, Value, in_order
from tarl_lint.message_fields import FIELDS

# maximum number of visited objects of a result that is not cached, since finding it again is as fast as checking it
FEW = 4


@dataclass(slots=True, eq=False)
class Visit:
    """State of one traversal: the nodes inside visited objects, and the objects with data of each points-to set."""

    known: dict[Obj, Nodes] = field(default_factory=dict)
    laden: dict[frozenset[Obj], list[Obj]] = field(default_factory=dict)


def deep(ctx: Interpreter, objects: frozenset[Obj]) -> Nodes:
    """Return all nodes whose data is inside objects; the result is cached until something is stored.

    Results for at most FEW objects are not cached until the same objects have led to more.
    """
    if len(objects) == 1:
        (obj,) = objects
        if not obj.laden:
            ctx.store.doubt(obj)
            return NONE
    store = ctx.store
    if len(objects) <= FEW and objects not in store.wide:
        visit = Visit()
        nodes = _all(ctx, objects, visit)
        if len(visit.known) > FEW:
            ctx.count(len(visit.known))
            store.wide.add(objects)
        return nodes
    outer = store.reads
    key = (objects, ctx.stack[-1] if ctx.stack else None)
    last = store.insides.get(key)
    if last is not None:
        fresh = last.tick == store.tick and last.grown == ctx.graph.grown
        if fresh or _still(ctx, last):
            outer.add(last.reads)
            return last.nodes
    reads = store.reads = ctx.graph.reads = Reads()
    grown, tick = ctx.graph.grown, store.tick
    visit = Visit()
    nodes = _all(ctx, objects, visit)
    ctx.count(len(visit.known))
    store.reads = ctx.graph.reads = outer
    outer.add(reads)
    store.insides[key] = Inside(nodes, reads, *store.found_by(reads), tick, grown)
    return nodes


def _all(ctx: Interpreter, objects: frozenset[Obj], visit: Visit) -> Nodes:
    """Return the nodes inside several objects."""
    nodes = NONE
    for obj in in_order(objects):
        nodes |= _deep(ctx, obj, visit, 0)
    return nodes


def _still(ctx: Interpreter, last: Inside) -> bool:
    """Return whether a cached result is still valid although something was stored since."""
    store, graph = ctx.store, ctx.graph
    if not unchanged(last.reads, last.found, last.stored, store, graph):
        return False
    last.tick, last.grown = store.tick, graph.grown
    return True


def _deep(ctx: Interpreter, obj: Obj, visit: Visit, depth: int, *, counted: bool = False) -> Nodes:
    """Return the nodes inside one object; cycles are entered once.

    With `counted`, the caller has added the summary field of the enclosing object, so the result lacks that field and
    is not cached.
    """
    if obj.kind in HOLLOW or depth > MAX_NESTING:
        return NONE
    if not obj.laden:
        ctx.store.doubt(obj)
        return NONE
    known = visit.known
    inside = known.get(obj)
    if inside is not None:
        return inside
    known[obj] = NONE
    if obj.kind == "instance" and _node_like(ctx, obj):
        return NONE
    ctx.store.look(obj)
    definition = defined(ctx, obj)
    overwritten = definition != "" and replaced(ctx, obj, definition)
    found: set[int] = set()
    whole = not counted or ANY in obj.fields
    if not overwritten and whole:
        found |= heap.content(ctx, obj).deps
    get = ctx.store.get
    for name in list(obj.fields):
        value = get((obj, name)) if name != ANY or not overwritten else None
        if value is not None:
            if value.deps:
                found |= ctx.settled(value) if name.isidentifier() else value.deps
            if value.pts:
                found |= _behind(ctx, value, visit, depth + 1)
    for sub in _parts(ctx, obj, overwritten):
        found |= _deep(ctx, sub, visit, depth + 1, counted=not overwritten)
    inside = frozenset(found)
    if whole:
        known[obj] = inside
    else:
        del known[obj]
    return inside


def _parts(ctx: Interpreter, obj: Obj, overwritten: bool) -> list[Obj]:
    """Return the parts of an object that can hold data of their own.

    Parts without fields are left out, since they hold only data of the enclosing object. If such a part gets
    a field later, readers of the enclosing object are notified.
    """
    if not obj.subs:
        return []
    ctx.look(obj.subs.values())
    return [
        sub
        for name, sub in obj.subs.items()
        if (sub.fields or sub.subs or overwritten or not sub.laden)
        and sub is not obj
        and ctx.store.get((obj, name)) is None
    ]


def defined(ctx: Interpreter, obj: Obj) -> str:
    """Return the name of a message's definition, also for a nested message; empty if unknown."""
    if obj.parent is None or not obj.whole.defined:
        return obj.whole.defined
    outer = FIELDS.get(defined(ctx, obj.parent), {})
    return outer.get(obj.name, "")


def replaced(ctx: Interpreter, obj: Obj, kind: str) -> bool:
    """Return whether this run has overwritten every field of a message, or of a copy of it."""
    fields = FIELDS.get(kind)
    if fields is not None:
        ctx.store.reads.look(obj)
    return fields is not None and all(
        heap.written_here(ctx, obj, name)
        or (inner != "" and name in obj.subs and replaced(ctx, obj.subs[name], inner))
        for name, inner in fields.items()
    )


def _behind(ctx: Interpreter, value: Value, visit: Visit, depth: int) -> Nodes:
    """Return the nodes inside the objects of a field, as the field's carriers pass them on."""
    inner = _inside_all(ctx, value.pts, visit, depth)
    return ctx.graph.through(inner, value.deps) if inner else inner


def _inside_all(ctx: Interpreter, objects: frozenset[Obj], visit: Visit, depth: int) -> Nodes:
    """Return the nodes inside objects.

    Many fields point to the same objects, so most of these were visited before.
    """
    laden = visit.laden.get(objects)
    if laden is None:
        laden = visit.laden[objects] = _laden(ctx, objects)
    if depth > MAX_NESTING or not laden:
        return NONE
    insides = [*map(visit.known.get, laden)]
    if None in insides:
        insides = [_deep(ctx, obj, visit, depth) for obj in laden]
    full = [inside for inside in insides if inside]
    # a single set is reused, because its hash is already computed
    return full[0] if len(full) == 1 else NONE.union(*full)


def _laden(ctx: Interpreter, objects: frozenset[Obj]) -> list[Obj]:
    """Return the objects that may contain data, in order of creation; record that the others contain none."""
    found = []
    for obj in in_order(objects):
        if obj.kind in HOLLOW:
            continue
        if obj.laden:
            found.append(obj)
        else:
            ctx.store.doubt(obj)
    return found


def _node_like(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an instance is a program rather than data, so that passing it on passes no data."""
    info = obj.info.info if isinstance(obj.info, Obj) else None
    if not isinstance(info, ClassInfo):
        return False
    return info.opaque or any(_is_self(ctx, f, obj) for f in ctx.stack if "self" in f.fields)


def _is_self(ctx: Interpreter, frame: Frame, obj: Obj) -> bool:
    value = ctx.store.get((frame, "self"))
    return value is not None and obj in value.pts
