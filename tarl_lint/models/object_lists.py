"""Lists of objects of the analysed classes: their order is known as long as each object is appended once.

The order matters if a loop calls the objects, and an earlier object decides whether later objects are called.
"""

from __future__ import annotations

from collections.abc import Sequence

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, recency
from tarl_lint.memory.values import Value, pointer
from tarl_lint.models import sizes


def place(ctx: Interpreter, base: Value, news: Sequence[Value]) -> int | None:
    """Return the index of the first object that a call appends to a list; None if unknown."""
    if len(base.pts) != 1 or not news or not all(map(is_object, news)):
        return None
    (obj,) = base.pts
    known = sizes.unpacked(ctx, base) if obj.kind == "sequence" else None
    if known is None or len(known) + len(news) > sizes.MAX_KNOWN or not all(map(is_object, known)):
        return None
    distinct = frozenset(o for value in (*known, *news) for o in value.pts)
    ctx.look(distinct)
    if len(distinct) < len(known) + len(news) or any(o.laden for o in distinct):
        return None  # a loop or a callback appends again, or the objects carry data
    return len(known) if recency.single(ctx, obj) else None


def is_object(element: Value) -> bool:
    """Return whether a value is certainly one object of an analysed class."""
    return len(element.pts) == 1 and all(o.kind == "instance" for o in element.pts)


def asked(ctx: Interpreter, elements: Sequence[Value]) -> bool:
    """Return whether all loop elements are objects, integers, or tuples with objects."""
    for element in elements:
        parts = sizes.unpacked(ctx, element) or [element]
        known = all(is_object(part) or part.fixed() for part in parts)
        if not known or not (any(map(is_object, parts)) or isinstance(element.constant()[1], int)):
            return False
    return True


def without_empty(ctx: Interpreter, source: Value) -> Value:
    """Return a value without empty lists, if it may be a full one, as in `children or []`."""
    if len(source.pts) < 2 or any(o.kind != "sequence" for o in source.pts):
        return source
    full = frozenset(o for o in source.pts if not sizes.is_empty(ctx, pointer(o)))
    return Value(source.deps, full, source.consts) if full else source


def appended(ctx: Interpreter, base: Value, first: int, news: Sequence[Value]) -> None:
    """Store objects at the end of a list; `first` is the index that `place` returned."""
    (obj,) = base.pts
    for number, value in enumerate(news):
        ctx.store.put((obj, heap.item_field(first + number)), value)
