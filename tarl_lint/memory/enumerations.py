"""Members of enumerations whose values are lists or tuples, such as `SCAN = ("/scan", LaserScan)`.

A member is represented by its value. The sequence of such a member is marked, so that the properties and methods of its
class are found on it, and it is a key of its own in mappings. Members with constant values need no mark.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, recency
from tarl_lint.memory.values import MEMBER, ClassInfo, Obj, Value, const, join, lineage, pointer

VALUES: Final = ("value", "_value_")
NAMES: Final = ("name", "_name_")


def mark(ctx: Interpreter, cls: Obj) -> Iterator[tuple[Obj, list[Value]]]:
    """Replace the sequences in an enumeration's class by marked copies; yield each copy with its elements."""
    ctx.store.look(cls)
    for name in list(cls.fields):
        value = ctx.store.get((cls, name)) if name.isidentifier() and not name.startswith("_") else None
        known = ctx.ops.unpacked(ctx, value) if value is not None else None
        if value is None or not known:
            continue
        member = recency.intern(ctx, "sequence", (MEMBER, cls.key, name), MEMBER)
        member.describe((cls, name))
        for number, element in enumerate(known):
            ctx.store.put((member, heap.item_field(number)), element)
        ctx.store.put((cls, name), pointer(member, value.deps))
        ctx.members = True
        yield member, known


def enumerates(cls: Obj) -> bool:
    """Return whether `Class[x]` may be a member of an enumeration; of other classes, it is the class itself."""
    infos = [owner.info for owner in lineage(cls)]
    names = {e.rpartition(".")[2] for i in infos if isinstance(i, ClassInfo) for e in i.external}
    return any(name.endswith(("Enum", "Flag")) for name in names)


def is_member(obj: Obj) -> bool:
    """Return whether an object is a marked member."""
    return obj.name == MEMBER and obj.kind == "sequence"


def attribute(ctx: Interpreter, base: Value, name: str) -> Value | None:
    """Return an attribute that members get from their class; None if no possible object is a member."""
    found: Value | None = None
    for obj in base.objects:
        if not is_member(obj) or not isinstance(obj.info, tuple):
            continue
        cls, own = obj.info
        if name in VALUES:
            value = pointer(obj)
        elif name in NAMES:
            value = const(own)
        else:
            own_value = ctx.store.get((obj, name))  # set by `__init__`
            value = own_value if own_value is not None else _inherited(ctx, obj, cls, name)
        found = value if found is None else join(found, value)
    return found


def _inherited(ctx: Interpreter, obj: Obj, cls: Obj, name: str) -> Value:
    for owner in lineage(cls):
        value = ctx.store.get((owner, name))
        if value is not None:
            return heap.bind(ctx, value, obj, owner)
    return Value()
