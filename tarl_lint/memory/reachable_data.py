"""Data reachable inside objects, at any depth."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass, field

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory.cached_data import Contents, Inside, Split
from tarl_lint.memory.heap import HOLLOW
from tarl_lint.memory.object_contents import contents, note
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.recency import MAX_NESTING
from tarl_lint.memory.values import NONE, ClassInfo, Nodes, Obj, Value, in_order

# results for which at most this number of objects was visited are not cached, because computing such a result again
# is as fast as checking a cached one
FEW = 4
# kinds of objects that are always searched; HOLLOW objects and instances of some classes are skipped
PLAIN = frozenset(["lib", "sequence", "mapping", "message"])
VISIT = 60  # visiting an object takes as long as looking up this number of values


@dataclass(slots=True, eq=False)
class Visit:
    """State of one traversal: the nodes inside visited objects and, for each points-to set, the objects with data."""

    known: dict[Obj, Nodes] = field(default_factory=dict)
    read: list[Contents] = field(default_factory=list)  # contents of the visited objects
    empty: set[Obj] = field(default_factory=set)  # objects without data to which a visited object points
    receivers: frozenset[Obj] | None = None  # receivers of the running methods; None until they are needed


def deep(ctx: Interpreter, objects: frozenset[Obj]) -> Nodes:
    """Return all nodes whose data is inside objects; the result is cached until something is stored.

    A result for at most FEW objects is not cached unless these objects have earlier led to more objects.
    """
    if len(objects) == 1:
        (obj,) = objects
        if not obj.laden:
            ctx.store.doubt(obj)
            return NONE
        if obj.kind in PLAIN and objects not in ctx.store.wide:
            own = contents(ctx, obj)
            # the same result as below, computed without the state of a search
            if not own.steps and not own.parts:
                note(ctx, own)
                ctx.work.handled += VISIT
                return own.all
    store = ctx.store
    visit = Visit()
    if len(objects) <= FEW and objects not in store.wide:
        nodes = _all(ctx, objects, visit)
        if len(visit.known) > FEW:
            ctx.count(len(visit.known))
            store.wide.add(objects)
        for own in visit.read:
            note(ctx, own)
        for obj in visit.empty:
            store.reads.look(obj)
        ctx.work.handled += VISIT * len(visit.known)
        if visit.receivers is not None:
            _note_receivers(ctx)
        return nodes
    receivers = visit.receivers = _receivers(ctx)
    key = (objects, receivers)
    last = store.insides.get(key)
    if last is None or not _valid(ctx, last):
        last = store.insides[key] = _searched(ctx, objects, visit)
    store.reads.add(last.reads)
    if last.receivers:
        _note_receivers(ctx)
    return last.nodes


def _searched(ctx: Interpreter, objects: frozenset[Obj], visit: Visit) -> Inside:
    """Return the nodes inside objects, together with everything on which this result depends."""
    store, outer = ctx.store, ctx.store.reads
    reads = store.reads = ctx.graph.reads = Reads()
    grown, tick = ctx.graph.grown, store.tick
    nodes = _all(ctx, objects, visit)
    ctx.count(len(visit.known))
    ctx.work.handled += VISIT * len(visit.known)
    store.reads = ctx.graph.reads = outer
    met = any(obj.kind == "instance" for obj in visit.known)
    return Inside(nodes, _reads(reads, visit.read, visit.empty), visit.read, visit.empty, met, tick, grown)


def _reads(graph: Reads, read: Sequence[Contents], empty: Set[Obj]) -> Reads:
    """Return the reads of a search that read these contents; `graph` holds the reads of the value-flow graph."""
    reads = Reads(held=graph.held, facts=graph.facts)
    reads.keys.update(*[own.keys for own in read])
    reads.stored.update(*[own.stored for own in read])
    for own in read:
        reads.objects.update(own.objects)
    reads.objects.update([(obj, obj.stamp) for obj in empty])
    return reads


def _valid(ctx: Interpreter, last: Inside) -> bool:
    """Return whether a cached result is still valid: all objects in which it was found have the same data."""
    store, graph = ctx.store, ctx.graph
    if last.tick == store.tick and last.grown == graph.grown:
        return True
    if any(obj.laden for obj in last.empty):
        return False
    ctx.work.handled += len(last.read)
    now = [contents(ctx, own.obj) for own in last.read]
    known = last.reads.objects
    if now != last.read or any(known[obj] != obj.stamp for obj in last.empty):
        for old, new in zip(last.read, now, strict=True):
            if old is not new and not new.alike(old):
                return False
        last.read = now
        last.reads = _reads(last.reads, now, last.empty)
    reads = last.reads
    if reads.held and not graph.as_passed(reads.held):
        return False
    if any(question(of) != answer for (question, of), answer in reads.facts.items()):
        return False
    last.tick, last.grown = store.tick, graph.grown
    return True


def _all(ctx: Interpreter, objects: frozenset[Obj], visit: Visit) -> Nodes:
    """Return the nodes inside several objects."""
    nodes = NONE
    for obj in in_order(objects):
        nodes |= _deep(ctx, obj, visit, 0)
    return nodes


def _deep(ctx: Interpreter, obj: Obj, visit: Visit, depth: int, *, counted: bool = False) -> Nodes:
    """Return the nodes inside one object; a cycle is entered once.

    With `counted`, the caller has already added the summary field of the enclosing object. The result then lacks
    this field and is not cached.
    """
    if obj.kind in HOLLOW or depth > MAX_NESTING:
        return NONE
    if not obj.laden:
        visit.empty.add(obj)
        ctx.store.doubt(obj)
        return NONE
    known = visit.known
    inside = known.get(obj)
    if inside is not None:
        return inside
    known[obj] = NONE
    if obj.kind == "instance" and _node_like(ctx, obj, visit):
        return NONE
    own = contents(ctx, obj)
    visit.read.append(own)
    whole = not counted or own.summarised
    found = [own.nodes, own.summary] if whole else [own.nodes]
    for number, value in enumerate(own.steps):
        inner = ctx.settled(value) if number in own.constants else _behind(ctx, value, visit, depth + 1)
        if inner:
            found.append(inner)
    found += [_deep(ctx, sub, visit, depth + 1, counted=not own.overwritten) for sub in own.parts]
    inside = NONE.union(*found)
    if whole:
        known[obj] = inside
    else:
        del known[obj]
    return inside


def _behind(ctx: Interpreter, value: Value, visit: Visit, depth: int) -> Nodes:
    """Return the nodes inside the objects of a field, after the field's carriers have passed them on."""
    inner = _inside_all(ctx, value.pts, visit, depth)
    return ctx.graph.through(inner, value.deps) if inner else inner


def _inside_all(ctx: Interpreter, objects: frozenset[Obj], visit: Visit, depth: int) -> Nodes:
    """Return the nodes inside objects.

    Many fields point to the same objects, so most of these were visited before.
    """
    laden = _laden(ctx, objects, visit)
    if depth > MAX_NESTING or not laden:
        return NONE
    known = visit.known
    insides = [*map(known.get, laden)]
    if None in insides:
        insides = [
            inside if inside is not None else _deep(ctx, obj, visit, depth)
            for obj, inside in zip(laden, insides, strict=True)
        ]
    # a single set is reused, because its hash is already computed
    if len(insides) == 1:
        return insides[0] or NONE
    full = [inside for inside in insides if inside]
    return full[0] if len(full) == 1 else NONE.union(*full)


def _laden(ctx: Interpreter, objects: frozenset[Obj], visit: Visit) -> Sequence[Obj]:
    """Return the objects that may contain data, in order of creation; record that the other objects contain no data."""
    store = ctx.store
    split = store.split.get(objects)
    if split is None or split.loaded != store.shared.loaded:
        known = [obj for obj in in_order(objects) if obj.kind not in HOLLOW]
        empty = frozenset(obj for obj in known if not obj.laden)
        split = store.split[objects] = Split(
            tuple(obj for obj in known if obj.laden), empty, list(empty), store.shared.loaded
        )
    if split.empty:
        visit.empty |= split.empty
        if split.doubted:
            split.doubted = [obj for obj in split.doubted if not store.doubt(obj)]
    return split.laden


def _node_like(ctx: Interpreter, obj: Obj, visit: Visit) -> bool:
    """Return whether an instance is a program rather than data, so that passing it on passes no data."""
    info = obj.info.info if isinstance(obj.info, Obj) else None
    if not isinstance(info, ClassInfo):
        return False
    if info.opaque:
        return True
    if visit.receivers is None:
        visit.receivers = _receivers(ctx)
    return obj in visit.receivers


def _receivers(ctx: Interpreter) -> frozenset[Obj]:
    """Return the receivers of the running methods."""
    values = (ctx.store.peek((frame, "self")) for frame in ctx.stack if "self" in frame.fields)
    return frozenset[Obj]().union(*(value.pts for value in values if value is not None))


def _note_receivers(ctx: Interpreter) -> None:
    """Make the running call depend on the receivers of the running methods."""
    for frame in ctx.stack:
        if "self" in frame.fields:
            ctx.store.get((frame, "self"))
