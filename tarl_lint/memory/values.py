"""Abstract values and the objects they point to."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable
from dataclasses import dataclass, field
from itertools import count
from operator import attrgetter
from typing import Final

from tarl_lint.ir import nodes as ir

Nodes = frozenset[int]
Consts = frozenset[object] | None  # None if the constants are unknown
Branches = frozenset[tuple[int, str]]

NONE: Nodes = frozenset()
# constants of a value that is certainly an object: such a value cannot be a constant, and in particular not None
NO_CONSTANTS: frozenset[object] = frozenset()
BY_CLASS: Final = "by its class"  # `info` of an instance of a library class, usually a message
PLAIN_BASES = frozenset(["typing.NamedTuple", "typing.Protocol", "abc.ABC", "enum.Enum", "enum.IntEnum"])
NUMBERS = count()  # counter that numbers objects in order of creation
NUMBER: Final = attrgetter("number")
MAX_CONSTS = 4
MAX_TEXTS = 64  # maximum number of string constants of a value; enough for a table of topic names
MAX_DEPTH = 6  # maximum nesting depth of embedded objects
# maximum depth to which nested elements are tracked separately; the number of objects grows exponentially with it
MAX_ELEMENTS = 2
MAX_CELLS = 16  # maximum number of nested elements tracked separately in a library object, such as a matrix
DATA: Final = "<data>"  # entry of `Obj.changes`: the object received its first data
OLDER: Final = "older"  # last part of the key of the summary of an allocation site's older objects
MESSAGES = frozenset(["message", "goal"])  # kinds of objects that are data themselves


class Obj:
    """An abstract object, identified by its allocation site, definition, or enclosing object."""

    __slots__ = (
        "cells",
        "changes",
        "defined",
        "depth",
        "edition",
        "elements",
        "fields",
        "holders",
        "info",
        "inside",
        "key",
        "kind",
        "laden",
        "many",
        "name",
        "number",
        "outermost",
        "parent",
        "stamp",
        "subs",
    )  # fmt: skip

    def __init__(self, kind: str, key: object, name: str = "", parent: Obj | None = None) -> None:
        self.kind = kind
        self.number = next(NUMBERS)
        self.key = key
        self.name = name
        self.parent = parent
        self.outermost: Obj | None = parent.whole if parent is not None else None
        self.depth: int = parent.depth + 1 if parent is not None else 0
        self.elements: int = parent.elements + 1 if parent is not None and name.startswith("[") else 0
        self.many: bool = parent.many if parent is not None else False
        # field → objects that were stored there last, in the order of the first stores; `holders` and `inside` of
        # these objects are up to date, so storing the same objects again changes nothing
        self.fields: dict[str, frozenset[Obj]] = {}
        self.subs: dict[str, Obj] = {}
        self.holders: dict[tuple[Obj, str], None] = {}  # keys that ever held a pointer to this object
        self.info: object = None
        self.defined = ""  # name of the definition, if this object is a message
        self.laden: bool = (
            parent.laden if parent is not None else kind in MESSAGES
        )  # whether this object may contain data, at any depth
        self.cells = 0  # number of nested elements tracked separately in this object so far
        # number of changes of this object and its parts; counted only for outermost objects
        self.edition = 0
        self.stamp = 0  # version of this object: the length of `changes`
        self.changes: list[
            str | Obj | None
        ] = []  # added fields and parts, DATA, or None for a change of meaning
        # objects into which a pointer to this object was stored while it was not laden
        self.inside: dict[Obj, None] = {}

    def sub(self, name: str) -> Obj:
        """Return the object embedded under a field; at depth MAX_DEPTH, the object itself also stands for its parts."""
        if self.depth >= MAX_DEPTH or (self.elements >= MAX_ELEMENTS and name.startswith("[")):
            return self
        found = self.subs.get(name)
        if found is None:
            if self.kind == "lib" and self.elements and name.startswith("["):
                if self.whole.cells >= MAX_CELLS:
                    return self
                self.whole.cells += 1
            found = self.subs[name] = Obj(self.kind, (self.key, name), name, self)
            self.changed(found)
        return found

    def path(self) -> str:
        """Return the dotted path from the outermost object."""
        if self.parent is None:
            return ""
        outer = self.parent.path()
        return f"{outer}.{self.name}" if outer else self.name

    @property
    def whole(self) -> Obj:
        """Return the outermost enclosing object."""
        return self.outermost or self

    @property
    def site(self) -> Hashable:
        """Return the allocation site that an object shares with the summary of older objects."""
        key = self.key
        aged = isinstance(key, tuple) and len(key) == 2 and key[1] == OLDER
        return (self.kind, key[0] if aged and isinstance(key, tuple) else key)

    def describe(self, info: object) -> None:
        """Set `info`, the meaning of this object, and increment its stamp if the meaning changed."""
        if info is not self.info and info != self.info:
            self.changed()
        self.info = info

    def changed(self, added: str | Obj | None = None) -> None:
        """Record a change: an added field or part, the first data (DATA), or None for a change of meaning."""
        self.stamp += 1
        (self.outermost or self).edition += 1
        self.changes.append(added)

    def release(self) -> None:
        """Drop references, to break reference cycles."""
        for sub in self.subs.values():
            if sub is not self:
                sub.release()
        self.subs.clear()
        self.changes.clear()
        self.holders.clear()
        self.inside.clear()
        self.fields.clear()
        self.info = None

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name or self.key}>"


Key = tuple[Obj, str]


@dataclass(frozen=True, slots=True)
class ClassKey:
    """A class, or a member of an enumeration, as the key of a mapping."""

    key: object


MEMBER: Final = "member of an enumeration"  # name of the sequence that represents such a member


class Symbolic(str):
    """A string that contains a parameter's value, which only the launch of the node determines."""

    __slots__ = ()


GIVEN: Final = Symbolic("\0given\0")  # a text of a parameter, the environment or the command line


class Value:
    """An abstract value: the nodes of its data, the objects that it may be, its constants."""

    __slots__ = ("consts", "deps", "pts")

    def __init__(self, deps: Nodes = NONE, pts: frozenset[Obj] = frozenset(), consts: Consts = None) -> None:
        self.deps = deps
        self.pts = pts
        self.consts = consts

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Value)
            and self.deps == other.deps
            and self.pts == other.pts
            and self.consts == other.consts
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Value({sorted(self.deps)}, {list(self.pts)}, {self.consts})"

    @property
    def objects(self) -> list[Obj]:
        """Return the objects in order of creation."""
        pts = self.pts
        return sorted(pts, key=NUMBER) if len(pts) > 1 else list(pts)

    def constant(self) -> tuple[bool, object]:
        """Return (whether the value is one known constant, the constant)."""
        if self.consts is not None and len(self.consts) == 1 and not self.pts:
            constant = next(iter(self.consts))
            return (False, None) if type(constant) is Symbolic else (True, constant)
        return False, None

    def fixed(self) -> bool:
        """Return whether the value is the same constant on all paths."""
        return self.constant()[0]

    def keys(self) -> Consts:
        """Return the constants of a value; None if others are possible, such as a string that the launch determines."""
        return None if self.consts and any(type(c) is Symbolic for c in self.consts) else self.consts

    def item_keys(self) -> Consts:
        """Return the constants, classes and members that a value may be as an index; None if others are possible."""
        if not self.pts:
            return self.keys()
        known = all(o.kind == "class" or o.name == MEMBER for o in self.pts)
        return frozenset(ClassKey(o.key) for o in self.pts) if known else None

    def default_keys(self) -> frozenset[str]:
        """Return the defaults of a text that is known only on the robot; empty for other values."""
        replaceable = not self.pts and self.keys() is None and self.replaceable()
        return frozenset(self.names()) if replaceable else frozenset()

    def consts_in(self, other: Value) -> bool:
        """Return whether each constant of this value is also a constant of another value."""
        return other.consts is None or (self.consts is not None and self.consts <= other.consts)

    def texts(self) -> tuple[str, ...]:
        """Return the possible strings of a value, sorted; empty if it may be anything else."""
        return self.names() if self.keys() is not None else ()

    def names(self) -> tuple[str, ...]:
        """Return the possible strings of a value, sorted, including those that the launch of the node determines.

        A string that is known only on the robot is left out; the other strings are then defaults.
        """
        if self.consts is None or not all(isinstance(c, str) for c in self.consts):
            return ()
        return tuple(sorted(str(c) for c in self.consts if GIVEN not in str(c)))

    def replaceable(self) -> bool:
        """Return whether the actual string is known only on the robot, and may be different from the known strings."""
        return self.consts is not None and any(isinstance(c, str) and GIVEN in c for c in self.consts)


def in_order(objects: Collection[Obj]) -> list[Obj]:
    """Return objects in order of creation; the order of a set depends on memory addresses."""
    return sorted(objects, key=NUMBER) if len(objects) > 1 else list(objects)


BOTTOM = Value(consts=frozenset())
UNKNOWN = Value()
ABSENT = Value(consts=frozenset(["<absent>"]))  # value of an unset field of a new object


def join(a: Value, b: Value) -> Value:
    """Return the join of two values; this is `a` itself if `a` covers `b`."""
    if a is b or b is BOTTOM:
        return a
    if a is BOTTOM:
        return b
    deps = a.deps if b.deps <= a.deps else a.deps | b.deps
    pts = a.pts if b.pts <= a.pts else a.pts | b.pts
    consts = join_consts(a.consts, b.consts)
    if deps is a.deps and pts is a.pts and consts == a.consts:
        return a
    return Value(deps, pts, consts)


def join_consts(a: Consts, b: Consts) -> Consts:
    """Return the union of constants; None (unknown) if there are too many."""
    if a is None or b is None:
        return None
    if b <= a:
        return a
    both = a | b
    if len(both) <= MAX_CONSTS or (len(both) <= MAX_TEXTS and all(isinstance(c, str) for c in both)):
        return both
    return None


def join_all(values: Iterable[Value]) -> Value:
    """Join any number of values."""
    result = BOTTOM
    for value in values:
        result = join(result, value)
    return result


def pointer(obj: Obj, deps: Nodes = NONE) -> Value:
    """Return a value that points to one object."""
    return Value(deps, frozenset([obj]))


def certain_pointer(obj: Obj) -> Value:
    """Return a value that certainly points to one object, so that it is not None."""
    return Value(pts=frozenset([obj]), consts=NO_CONSTANTS)


def const(value: object) -> Value:
    """Return a value of one constant; the value is unknown if the constant is not hashable."""
    try:
        return Value(consts=frozenset([value]))
    except TypeError:
        return UNKNOWN


@dataclass(slots=True, eq=False)
class ClassInfo:
    """A class of the analysed files; `opaque` if a base class is not in them."""

    name: str
    qualname: str
    bases: list[Obj] = field(default_factory=list)
    external: list[str] = field(default_factory=list)
    statement: ir.Class | None = None
    module: str = ""
    # names with an annotation in the body: the fields, if the class is a dataclass
    fields: tuple[str, ...] = ()
    # the analysed metaclass of this class and of the classes that inherit from it
    metaclass: Obj | None = None
    named: bool = False  # whether the class is a named tuple, whose fields are also elements

    @property
    def opaque(self) -> bool:
        """Return whether code outside the files can access attributes and call methods of the class's instances."""
        inherited = any(isinstance(b.info, ClassInfo) and b.info.opaque for b in self.bases)
        return inherited or any(not _plain(e) for e in self.external)


def inherited_from(value: Value) -> set[str]:
    """Return the base classes outside the files, which may define a missing method."""
    classes = {o.info for o in value.pts if o.kind == "instance" and isinstance(o.info, Obj)}
    infos = [c.info for cls in classes for c in lineage(cls)]
    return {e for i in infos if isinstance(i, ClassInfo) for e in i.external if "." in e and not _plain(e)}


def closure_of(target: Obj) -> Obj:
    """Return the function of a bound method; other objects themselves."""
    found: Obj = target.info[0] if target.kind == "bound" and isinstance(target.info, tuple) else target
    return found


def function_of(target: Obj) -> ir.Function | None:
    """Return the analysed function that a call of an object runs; None if unknown."""
    closure = closure_of(target)
    found = closure.info[0] if closure.kind == "closure" and isinstance(closure.info, tuple) else None
    return found if isinstance(found, ir.Function) else None


def _plain(base: str) -> bool:
    """Return whether a library's class calls no methods of its subclasses. Examples are exceptions and containers."""
    return base in PLAIN_BASES or base.startswith("builtins.")


def lineage(cls: Obj) -> list[Obj]:
    """Return the class and its known bases in method resolution order, depth first without repeats."""
    if not (isinstance(cls.info, ClassInfo) and cls.info.bases):
        return [cls]
    found: dict[Obj, None] = {}
    pending = [cls]
    while pending:
        current = pending.pop(0)
        found.pop(current, None)
        found[current] = None
        if isinstance(current.info, ClassInfo) and len(found) < 50:
            pending = [*current.info.bases, *pending]
    return list(found)
