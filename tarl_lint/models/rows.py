"""Rows: the possible elements of a container; a loop over them is unrolled although their order is unknown."""

from __future__ import annotations

from ast import literal_eval

from tarl_lint.interpret.budget import MAX_ROWS
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.heap import KEYS
from tarl_lint.memory.values import BOTTOM, Obj, Value, const

MAX_MEMBERS = 100  # maximum number of attributes of an object or class over which a loop is unrolled
CONTAINERS = frozenset(["sequence", "mapping"])


def of(ctx: Interpreter, source: Value) -> list[Value]:
    """Return the different elements that iteration over containers may yield; [] if they are unknown, or too many."""
    if not source.pts or any(o.kind not in CONTAINERS for o in source.pts):
        return []
    return parts(ctx, heap.elements(ctx, source))


def hold_classes(ctx: Interpreter, source: Value) -> bool:
    """Return whether containers, or inner containers, may hold analysed classes."""
    if any(o.kind not in CONTAINERS for o in source.pts):
        return False
    for obj in heap.elements(ctx, source).objects:
        inner = heap.read_any(ctx, obj).pts if obj.kind == "sequence" else frozenset([obj])
        if any(o.kind == "class" for o in inner):
            return True
    return False


def parts(ctx: Interpreter, value: Value) -> list[Value]:
    """Return a value's different objects and constants; [] if unknown or fewer than two.

    The conditions of the value decide which of them there are, so each depends on the conditions.
    """
    constants = value.keys()
    if not 1 < len(value.pts) + len(constants or ()) <= MAX_ROWS or (constants is None and not value.pts):
        return []
    conditions = frozenset(map(ctx.graph.one_of, value.deps))
    found = [
        Value(value.deps | conditions, frozenset([o]), None if constants is None else BOTTOM.consts)
        for o in value.objects
    ]
    names = sorted(constants or (), key=lambda one: (type(one).__name__, repr(one)))
    return found + [Value(conditions, consts=frozenset([name])) for name in names]


def entries(ctx: Interpreter, base: Value) -> list[tuple[Value, Value]] | None:
    """Return the keys and values of mappings whose keys are known constants; None for unknown or too many keys."""
    found: list[tuple[Value, Value]] = []
    for obj in base.objects:
        own = _entries_of(ctx, obj)
        if own is None:
            return None
        found += [(const(key), heap.arrive(ctx, value, base.deps)) for key, value in own]
    return found if 1 < len(found) <= MAX_ROWS else None


def attributes(ctx: Interpreter, base: Value) -> list[tuple[Value, Value]] | None:
    """Return the names and values of one class or instance, as `vars(x)` has them; None for anything else."""
    owner = next(iter(base.pts)) if len(base.pts) == 1 else None
    if owner is None or (owner.kind != "class" and heap.attribute_names(ctx, owner) is None):
        return None
    ctx.store.look(owner)
    found: list[tuple[Value, Value]] = []
    for name in list(owner.fields):
        value = ctx.store.get((owner, name)) if name.isidentifier() and not name.startswith("__") else None
        if value is not None:
            found.append((const(name), heap.arrive(ctx, value, base.deps)))
    return found if 0 < len(found) <= MAX_MEMBERS else None


def _entries_of(ctx: Interpreter, obj: Obj) -> list[tuple[object, Value]] | None:
    if (
        obj.kind != "mapping"
        or heap.content(ctx, obj) is not BOTTOM
        or ctx.store.get((obj, KEYS)) is not None
    ):
        return None
    ctx.store.look(obj)
    found: list[tuple[object, Value]] = []
    for name in list(obj.fields):
        if not name.startswith("["):
            continue
        value = ctx.store.get((obj, name))
        ctx.graph.asked += 1
        if value is None:
            continue
        try:
            found.append((literal_eval(name[1:-1]), value))
        except (ValueError, SyntaxError):
            return None  # the key is not a literal but, for example, a class
    return found
