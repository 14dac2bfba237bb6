"""Join states after branches, loops and alternative callees."""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap
from tarl_lint.memory.store import Delta, Made
from tarl_lint.memory.values import (
    ABSENT,
    BOTTOM,
    BY_CLASS,
    Key,
    Value,
    join,
)

JOINS = 40  # number of joined values that count as one statement of work


def merge(ctx: Interpreter, deltas: Sequence[Delta]) -> None:
    """Set the state to the join of several continuations of the current one."""
    if len(deltas) == 1:
        ctx.store.absorb(deltas[0])
        return
    for key, value in joined(ctx, deltas).items():
        ctx.store.put(key, value)


def joined(ctx: Interpreter, deltas: Sequence[Delta]) -> Delta:
    """Return the join of continuations of the current state."""
    if len(deltas) > 1:
        deltas = [*{id(delta): delta for delta in deltas}.values()]
    if len(deltas) == 1:
        return deltas[0]
    keys: dict[Key, None] = {}
    for delta in deltas:
        keys.update(dict.fromkeys(delta))
    ctx.work.spent += len(keys) // JOINS
    result: Delta = {}
    first, others = deltas[0], deltas[1:]
    made: Made = {}
    for key in keys:
        value = first.get(key)
        # most keys have the same value in all continuations, because a layer repeats the stores of outer layers
        for other in others:
            if other.get(key) is not value:
                value = None
                break
        if value is None or value is ABSENT:
            value = _join_of(ctx, key, deltas, made)
        if value is not None:
            result[key] = value
    return result


def _join_of(ctx: Interpreter, key: Key, deltas: Sequence[Delta], made: Made) -> Value | None:
    """Return the join of a key's values in several continuations."""
    value: Value | None = None
    blank: Value | None = None
    before = False  # whether the value from before the branching is already joined into `value`
    for delta in deltas:
        here = delta.get(key)
        if here is None or here is ABSENT:
            if here is None:
                if before:
                    continue
                before = True
                here = _former(ctx, key, made)
            else:
                here = ctx.ops.default(ctx, *key)
            if here is not None and key[0].kind == "lib" and _unset(ctx, key, here):
                blank = here
                continue
        if here is not None:
            value = here if value is None else join(value, here)
    if blank is not None and (value is None or not _zero(value)):
        value = blank if value is None else join(value, blank)
    return value


def _unset(ctx: Interpreter, key: Key, value: Value) -> bool:
    """Return whether a library object's field is a field of a new message that is still unset."""
    owner = key[0]
    ctx.look(value.pts)
    return (
        owner.whole.info is BY_CLASS
        and bool(value.pts)  # an unset field is a part of its message, not a constant
        and not value.deps
        and all(o.parent is owner and not o.fields for o in value.pts)
        and heap.content(ctx, owner) is BOTTOM
    )


def _former(ctx: Interpreter, key: Key, made: Made) -> Value | None:
    """Return the value of a key in a continuation that does not change the key."""
    value = ctx.store.former(key, made)
    if value is not None:
        return value
    owner, name = key
    if owner.kind in ("frame", "module", "class", "closure"):
        return None
    if owner.kind != "message" and not ctx.store.made(owner.outermost or owner, made):
        return None  # on this path, the object does not exist
    return heap.content(ctx, owner) if name == "*" else ctx.ops.default(ctx, owner, name)


def _zero(value: Value) -> bool:
    """Return whether a value equals the default of a message field: zero, false or an empty string."""
    known, constant = value.constant()
    return known and constant is not None and not constant
