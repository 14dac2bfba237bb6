"""Remove and reorder elements of containers: the remaining elements depend on the conditions of a removal."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, recency, updates
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY, KEYS, item_field
from tarl_lint.memory.shared import BORN
from tarl_lint.memory.value_flow_graph import WHICH
from tarl_lint.memory.values import ABSENT, BOTTOM, NONE, Nodes, Obj, Value, join, join_all, pointer
from tarl_lint.models import equality, sizes

CONTAINERS = frozenset(["sequence", "mapping"])


@dataclass(frozen=True)
class Decision:
    """The nodes that decide which elements are left in a container, and how many; empty if no data decides."""

    left: Nodes
    length: Nodes


def decision(
    ctx: Interpreter,
    frame: Frame,
    slot: Hashable,
    decides: Nodes = NONE,
    *,
    base: Nodes = NONE,
    finds: bool = True,
) -> Decision:
    """Return the nodes that decide a removal: its conditions, the receiver `base`, and `decides`.

    `decides` selects the removed element by a comparison or an index. What is left therefore depends on it as on the
    condition of an `if` around the removal, and not as on data. The length depends on it only if `finds` is False,
    that is, if the call may remove nothing.
    """
    left = equality.selected(ctx, frame, ("moved", slot), decides | base, WHICH)
    length = equality.selected(ctx, frame, ("taken", slot), base if finds else decides | base)
    return Decision(ctx.reached(left), ctx.reached(length))


UNDECIDED: Final = Decision(NONE, NONE)


def take(ctx: Interpreter, base: Value, index: Value | None, decided: Decision) -> None:
    """Remove the element with this index or key; if it is None, remove the last element of a sequence."""
    for obj in base.objects:
        if obj.kind == "mapping":
            _take_key(ctx, base, obj, index, decided)
        elif obj.kind == "sequence":
            _take_index(ctx, base, obj, index, decided)


def _take_key(ctx: Interpreter, base: Value, obj: Obj, key: Value | None, decided: Decision) -> None:
    known, constant = key.constant() if key is not None else (False, None)
    if not known:
        scatter(ctx, obj, decided)
        return
    field, gone = heap.attribute_of_item(obj, constant), Value(decided.left)
    if alone(ctx, base, obj) and heap.content(ctx, obj) is BOTTOM:
        ctx.store.put((obj, field), gone if decided.left else ABSENT)
    elif decided.left:
        updates.weaken(ctx, obj, field, gone)
    _count(ctx, obj, decided)


def _take_index(ctx: Interpreter, base: Value, obj: Obj, index: Value | None, decided: Decision) -> None:
    known = sizes.unpacked(ctx, pointer(obj)) or []
    found, place = index.constant() if index is not None else (True, -1)
    exact = found and isinstance(place, int) and -len(known) <= place < len(known) and not decided.left
    if not exact or (obj, BORN) not in ctx.store.layers[-1]:
        scatter(ctx, obj, decided)  # the analysis does not know which element is removed, or on which paths
        return
    assert isinstance(place, int)  # noqa: S101 - checked above
    place %= len(known)
    if not alone(ctx, base, obj):
        scatter(ctx, obj)
        return
    for number, value in enumerate([*known[:place], *known[place + 1 :], ABSENT]):
        ctx.store.put((obj, item_field(number)), value)


def reverse(ctx: Interpreter, base: Value, decided: Decision) -> None:
    """Reverse sequences."""
    for obj in base.objects:
        known = sizes.unpacked(ctx, pointer(obj)) if obj.kind == "sequence" else None
        if known is not None and alone(ctx, base, obj):
            for number, value in enumerate(reversed(known)):
                ctx.store.put((obj, item_field(number)), _marked(value, decided))
        elif obj.kind == "sequence":
            scatter(ctx, obj, decided, shorter=False)


def scatter(ctx: Interpreter, obj: Obj, decided: Decision = UNDECIDED, *, shorter: bool = True) -> None:
    """Let every element be at any place, because an unknown element was removed or inserted."""
    ctx.store.look(obj)
    fields = [name for name in list(obj.fields) if name.startswith("[")]
    stored = {name: value for name in fields if (value := ctx.store.get((obj, name))) is not None}
    whole = _marked(join_all([heap.content(ctx, obj), *stored.values()]), decided)
    ordered = obj.kind == "sequence"
    for name, value in stored.items():
        ctx.store.put((obj, name), join(value, whole) if ordered else _perhaps(value, decided))
    if decided.left or (stored and ordered):
        held = heap.content(ctx, obj)
        ctx.store.put((obj, ANY), join(held, whole) if ordered else _marked(held, decided))
    if shorter:
        _count(ctx, obj, decided)


def empty(ctx: Interpreter, base: Value, decided: Decision) -> None:
    """Remove all elements of containers."""
    for obj in base.objects:
        if obj.kind not in CONTAINERS:
            continue
        if not alone(ctx, base, obj):
            scatter(ctx, obj, decided)
            continue
        places = [name for name in list(obj.fields) if name.startswith("[")] if decided.left else []
        sizes.empty(ctx, obj)
        for name in (ANY, *places) if decided.left else ():
            ctx.store.put((obj, name), Value(decided.left))
        _count(ctx, obj, decided)


def attribute(ctx: Interpreter, base: Value, name: str, decided: Decision) -> None:
    """Delete an attribute. If the class has a default for the attribute, this default is visible again."""
    for obj in base.objects:
        if obj.kind != "instance":
            continue
        default = _marked(ctx.ops.default(ctx, obj, name), decided)
        if alone(ctx, base, obj):
            ctx.store.put((obj, name), default)
        else:
            updates.weaken(ctx, obj, name, default)


def alone(ctx: Interpreter, base: Value, obj: Obj) -> bool:
    """Return whether a pointer certainly leads to this object."""
    return len(base.pts) == 1 and recency.single(ctx, obj)


def _count(ctx: Interpreter, obj: Obj, decided: Decision) -> None:
    if decided.length:
        sizes.decide_length(ctx, obj, decided.length)
    if decided.left and obj.kind == "mapping":
        updates.weaken(ctx, obj, KEYS, Value(decided.left))


def _perhaps(value: Value, decided: Decision) -> Value:
    """Return the value of an entry that may have been removed."""
    return join(value, Value(decided.left)) if decided.left else value


def _marked(value: Value, decided: Decision) -> Value:
    return Value(value.deps | decided.left, value.pts, value.consts) if decided.left else value
