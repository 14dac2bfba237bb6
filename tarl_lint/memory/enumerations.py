"""Members of enumerations: their values, and what their classes define for them.

A member of a `StrEnum`, an `IntEnum` or a `Flag` is represented by its value, and `auto()` by a number. A member of
another enumeration is a marked instance of its class. If the value of the member is a list or tuple, such as `SCAN
= ("/scan", LaserScan)`, this sequence is marked instead, so that the properties and methods of the class are found
on the sequence. Marked members are keys of their own in mappings.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, recency
from tarl_lint.memory.values import (
    MEMBER,
    NO_CONSTANTS,
    ClassInfo,
    Obj,
    Value,
    const,
    join,
    lineage,
    pointer,
)

VALUES: Final = ("value", "_value_")
NAMES: Final = ("name", "_name_")
AUTO: Final = "enum.auto"  # name of the object that `auto()` returns
# base classes whose members are numbers or strings themselves
MIXED: Final = frozenset(["IntEnum", "StrEnum", "IntFlag", "Flag", "int", "str", "float"])
MAPPING: Final = "__members__"
FUNCTIONS: Final = frozenset(["closure", "bound", "partial"])
DEFINED: Final = FUNCTIONS | {"class"}
KINDS: Final = frozenset(["sequence", "instance"])


def mark(ctx: Interpreter, cls: Obj) -> Iterator[tuple[Obj, list[Value]]]:
    """Replace members of an enumeration by marked members; yield each with the arguments of its `__init__`."""
    ctx.store.look(cls)
    mixed = not MIXED.isdisjoint(_bases(cls))
    for name, value in _number(ctx, cls):
        known = ctx.ops.unpacked(ctx, value)
        if known:
            member = recency.intern(ctx, "sequence", (MEMBER, cls.key, name), MEMBER)
            member.describe((cls, name))
            for number, element in enumerate(known):
                ctx.store.put((member, heap.item_field(number)), element)
            ctx.members = True
        elif not mixed and not any(o.kind in DEFINED for o in value.pts):
            member = recency.intern(ctx, "instance", (MEMBER, cls.key, name), MEMBER)
            member.describe(cls)
            for own, held in (*((v, value) for v in VALUES), *((n, const(name)) for n in NAMES)):
                ctx.store.put((member, own), held)
            known = [value]
        else:
            continue
        ctx.store.put((cls, name), Value(value.deps, frozenset([member]), NO_CONSTANTS))
        yield member, known


def _number(ctx: Interpreter, cls: Obj) -> list[tuple[str, Value]]:
    """Replace each `auto()` in an enumeration by its value; return the public attributes of the enumeration."""
    found: list[tuple[str, Value]] = []
    last: object = 0
    flags = any(name.endswith("Flag") for name in _bases(cls))
    texts = "StrEnum" in _bases(cls)
    for name, value in _public(ctx, cls):
        if any(o.kind == "lib" and o.name == AUTO for o in value.pts):
            number = last if isinstance(last, int) else 0
            value = const(name.lower() if texts else max(2 * number, 1) if flags else number + 1)
            ctx.store.put((cls, name), value)
        last = value.constant()[1] if value.fixed() else last
        found.append((name, value))
    return found


def _public(ctx: Interpreter, cls: Obj) -> Iterator[tuple[str, Value]]:
    """Yield the names and values of a class's attributes, except those that begin with an underscore."""
    for name in list(cls.fields):
        value = ctx.store.get((cls, name)) if name.isidentifier() and not name.startswith("_") else None
        if value is not None:
            yield name, value


def with_value(ctx: Interpreter, cls: Obj, value: Value) -> Value | None:
    """Return the marked member that `Class(value)` returns; None if no marked member has this value."""
    if not value.fixed() or value.deps:
        return None
    ctx.store.look(cls)
    for name in list(cls.fields):
        held = ctx.store.get((cls, name))
        for member in held.objects if held is not None else ():
            if member.kind == "instance" and is_member(member):
                own = ctx.store.get((member, VALUES[0]))
                if own is not None and own.fixed() and own.constant() == value.constant():
                    return held
    return None


def automatic(ctx: Interpreter, _: object) -> Value:
    """Return the result of `auto()`, which `mark` replaces by a number."""
    return pointer(recency.intern(ctx, "lib", AUTO, AUTO))


def members(ctx: Interpreter, cls: Obj) -> list[tuple[str, Value]] | None:
    """Return the names and values of an enumeration's members; None for other classes, or if a member is unknown."""
    if cls.kind != "class" or not enumerates(cls):
        return None
    ctx.store.look(cls)
    found: list[tuple[str, Value]] = []
    for name, value in _public(ctx, cls):
        if value.pts and all(o.kind in FUNCTIONS for o in value.pts):
            continue
        if not value.fixed() and not (value.pts and all(map(is_member, value.pts))):
            return None
        found.append((name, value))
    return found


def by_name(ctx: Interpreter, base: Value) -> Value | None:
    """Return the mapping `Class.__members__` of an enumeration; None for other objects."""
    known = members(ctx, next(iter(base.pts))) if len(base.pts) == 1 else None
    if not known:
        return None
    (cls,) = base.pts
    table = recency.intern(ctx, "mapping", (MEMBER, cls.key), MAPPING)
    for name, value in known:
        ctx.store.put((table, heap.item_field(name)), value)
    return pointer(table, base.deps)


def enumerates(cls: Obj) -> bool:
    """Return whether `Class[x]` may be a member of an enumeration.

    For other classes, `Class[x]` is the class itself.
    """
    return any(name.endswith(("Enum", "Flag")) for name in _bases(cls))


def _bases(cls: Obj) -> frozenset[str]:
    """Return the last parts of the names of all base classes outside the files."""
    infos = [owner.info for owner in lineage(cls)]
    return frozenset(e.rpartition(".")[2] for i in infos if isinstance(i, ClassInfo) for e in i.external)


def is_member(obj: Obj) -> bool:
    """Return whether an object is a marked member."""
    return obj.name == MEMBER and obj.kind in KINDS


def attribute(ctx: Interpreter, base: Value, name: str) -> Value | None:
    """Return an attribute that members get from their class; None if no possible object is a member."""
    found: Value | None = None
    for obj in base.objects:
        if not is_member(obj):
            continue
        value = _attribute(ctx, obj, name)
        value = heap.arrive(ctx, value, base.deps)
        found = value if found is None else join(found, value)
    return found


def _attribute(ctx: Interpreter, member: Obj, name: str) -> Value:
    if not isinstance(member.info, tuple):
        return heap.read_field(ctx, member, name)
    cls, own = member.info
    if name in VALUES:
        return pointer(member)
    if name in NAMES:
        return const(own)
    stored = ctx.store.get((member, name))  # set by `__init__`
    return stored if stored is not None else heap.through_class(ctx, member, cls, name) or Value()
