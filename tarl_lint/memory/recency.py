"""Create abstract objects; the newest object of an allocation site is kept apart from the older ones.

Recency abstraction, after Balakrishnan and Reps (SAS 2006).
"""

from __future__ import annotations

from collections.abc import Hashable

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import NEW
from tarl_lint.memory.shared import BORN
from tarl_lint.memory.store import AGING
from tarl_lint.memory.values import ABSENT, BOTTOM, OLDER, Obj, Value, join

MAX_NESTING = 7
# kinds of objects that may cease to represent one concrete object
CONTAINING = AGING - {"lib"}
MAKING = (ir.Call, ir.SequenceDisplay, ir.MappingDisplay, ir.Comprehension)


def intern(ctx: Interpreter, kind: str, key: Hashable, name: str = "") -> Obj:
    """Return the object with this key; create it at first use."""
    found = ctx.objects.get((kind, key))
    if found is None:
        found = ctx.objects[kind, key] = Obj(kind, key, name)
    return found


def allocate(ctx: Interpreter, kind: str, frame: Frame, slot: Hashable) -> Obj:
    """Return the newest object of an allocation site; merge the object that was newest before into the older ones."""
    statement = frame.statement
    key = (frame.id, statement.id if statement is not None else -1, slot, *frame.turn)
    obj = ctx.objects.get((kind, key))
    if obj is None:
        obj = ctx.objects[kind, key] = Obj(kind, key)
        ctx.store.reads.objects[obj] = NEW
        ctx.store.put((obj, BORN), BOTTOM)
        return obj
    renew(ctx, obj, frame)
    return obj


def renew(ctx: Interpreter, obj: Obj, frame: Frame) -> None:
    """Make an object the newest one of its allocation site.

    If the object that was newest before is in use, it is kept among the older ones.
    """
    if obj.kind == "lib":
        if obj.fields:
            _age(ctx, obj, frame)
    elif obj.kind in AGING and ctx.store.get((obj, BORN)) is not None:
        if obj in ctx.given:
            one_of_many(ctx, obj)
            return
        _age(ctx, obj, frame)
    if single(ctx, obj):
        clear_fields(ctx, obj)
    ctx.store.put((obj, BORN), BOTTOM)


def single(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an object represents a single concrete object. This root runs again as soon as that changes."""
    if obj.many:
        return False
    if obj.kind in CONTAINING:
        ctx.store.reads.single.add(obj)
        roots = ctx.shared.certain.get(obj)
        if roots is None:
            roots = ctx.shared.certain[obj] = {}
        roots[ctx.store.root] = None
    return True


def one_of_many(ctx: Interpreter, obj: Obj) -> None:
    """Let an object stand for several, such as all of its site if callbacks refer to it."""
    if not obj.many:
        obj.many = True
        ctx.shared.several.add(obj)
        ctx.pending.update(ctx.shared.certain.get(obj, {}))


def _age(ctx: Interpreter, obj: Obj, frame: Frame) -> None:
    """Make pointers to the object that was newest before point to the summary of the older ones."""
    ctx.store.reads.holders.setdefault(obj, len(obj.holders))
    replaced = _replaced(frame) if obj.kind != "lib" else ()
    holders = [
        k
        for k in obj.holders
        if k[0] is not obj and not (k[0] is frame and k[1] in replaced) and _holds(ctx, k, obj)
    ]
    if not holders:
        return
    older = ctx.objects.get((obj.kind, (obj.key, OLDER)))
    if older is None:
        older = ctx.objects[obj.kind, (obj.key, OLDER)] = Obj(obj.kind, (obj.key, OLDER))
        older.many = True
        older.name = obj.name
        if obj in ctx.chains:
            # the last object is listed twice, because it represents several objects
            ctx.chains[older] = (*ctx.chains[obj], ctx.chains[obj][-1])
    older.describe(obj.info)
    copy_fields(ctx, obj, older)
    ctx.graph.asked += len(obj.holders)
    without: dict[frozenset[Obj], frozenset[Obj]] = {}  # a cache, because many values share one set
    for key in holders:
        value = ctx.store.get(key)
        if value is not None:
            pts = without.get(value.pts)
            if pts is None:
                pts = without[value.pts] = (value.pts - {obj}) | {older}
            ctx.store.put(key, Value(value.deps, pts, value.consts))


def _replaced(frame: Frame) -> tuple[str, ...]:
    """Return the local variables to which the current statement assigns the new object."""
    s = frame.statement
    if not isinstance(s, ir.Assign) or not isinstance(s.value, MAKING):
        return ()
    return tuple(t.name for t in s.targets if isinstance(t, ir.Name) and t.scope == "local")


def _holds(ctx: Interpreter, key: tuple[Obj, str], obj: Obj) -> bool:
    value = ctx.store.get(key)
    return value is not None and obj in value.pts


def copy_fields(ctx: Interpreter, obj: Obj, older: Obj, depth: int = 0) -> None:
    """Join the fields of an object and its parts into the summary of older ones."""
    ctx.store.reads.look(obj)
    for name in list(obj.fields):
        value = ctx.store.get((obj, name))
        if value is not None:
            before = ctx.store.get((older, name))
            ctx.store.put((older, name), value if before is None else join(before, value))
    if depth < MAX_NESTING:
        for name, sub in list(obj.subs.items()):
            copy_fields(ctx, sub, older.sub(name), depth + 1)


def clear_fields(ctx: Interpreter, obj: Obj, depth: int = 0) -> None:
    """Reset all fields of an object and its parts to unset."""
    ctx.store.reads.look(obj)
    for name in list(obj.fields):
        ctx.store.put((obj, name), ABSENT)
    if depth < MAX_NESTING:
        for sub in list(obj.subs.values()):
            if sub is not obj:
                clear_fields(ctx, sub, depth + 1)
