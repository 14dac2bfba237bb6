"""Abstract values and the objects they point to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import count
from typing import Final

from tarl_lint.ir import nodes as ir

Nodes = frozenset[int]
Consts = frozenset[object] | None  # None: anything
Branches = frozenset[tuple[int, str]]

NONE: Nodes = frozenset()
BY_CLASS: Final = "by its class"  # `info` of a library's object that a class made: a message, mostly
PLAIN_BASES = frozenset(["typing.NamedTuple", "typing.Protocol", "abc.ABC", "enum.Enum", "enum.IntEnum"])
NUMBERS = count()  # of objects in the order in which they are made
MAX_CONSTS = 4
MAX_TEXTS = 24  # names of topics, mostly: a table of them may be long
MAX_DEPTH = 6  # of objects embedded in objects
MAX_ELEMENTS = 2  # elements of elements that are told apart: beyond, their indices give a power of objects
MAX_CELLS = 16  # elements of elements of one object of a library that are told apart: of a matrix, mostly
MESSAGES = frozenset(["message", "goal"])  # objects that bring data with them


class Obj:
    """An object, known by what makes it: allocation site, definition, or the object it is embedded in."""

    __slots__ = (
        "cells",
        "defined",
        "depth",
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
        # every field ever stored, in order, with objects that are known to be held there (`holders`, `inside`)
        self.fields: dict[str, frozenset[Obj]] = {}
        self.subs: dict[str, Obj] = {}
        self.holders: dict[tuple[Obj, str], None] = {}  # where pointers to it were stored
        self.info: object = None
        self.defined = ""  # of a message: the name of its definition
        self.laden: bool = (
            parent.laden if parent is not None else kind in MESSAGES
        )  # data may be in it, at any depth
        self.cells = 0  # elements of elements that it has by now
        self.stamp = (
            0  # how often a field or part was added to it, data came into it, or what it stands for changed
        )
        self.inside: dict[Obj, None] = {}  # objects that a pointer to it was stored in while it was not laden

    def sub(self, name: str) -> Obj:
        """Return the object embedded under a field; deep nesting folds into one."""
        if self.depth >= MAX_DEPTH or (self.elements >= MAX_ELEMENTS and name.startswith("[")):
            return self
        found = self.subs.get(name)
        if found is None:
            if self.kind == "lib" and self.elements and name.startswith("["):
                if self.whole.cells >= MAX_CELLS:
                    return self
                self.whole.cells += 1
            found = self.subs[name] = Obj(self.kind, (self.key, name), name, self)
            self.stamp += 1
        return found

    def path(self) -> str:
        """Return the dotted field that leads here from the outermost object."""
        if self.parent is None:
            return ""
        outer = self.parent.path()
        return f"{outer}.{self.name}" if outer else self.name

    @property
    def whole(self) -> Obj:
        """Return the outermost object that it is part of."""
        return self.outermost or self

    def describe(self, info: object) -> None:
        """Say what the object stands for, which may be another thing than before."""
        if info is not self.info and info != self.info:
            self.stamp += 1
        self.info = info

    def release(self) -> None:
        """Let go of what may lead back here."""
        for sub in self.subs.values():
            if sub is not self:
                sub.release()
        self.subs.clear()
        self.holders.clear()
        self.inside.clear()
        self.fields.clear()
        self.info = None

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name or self.key}>"


Key = tuple[Obj, str]


class Value:
    """What an expression may be: the nodes its data comes from, the objects it may be, its constants."""

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

    def constant(self) -> tuple[bool, object]:
        """Return whether the value is one known constant, and it."""
        if self.consts is not None and len(self.consts) == 1 and not self.pts:
            return True, next(iter(self.consts))
        return False, None

    def fixed(self) -> bool:
        """Tell whether the value is one constant, whichever way it came."""
        return self.consts is not None and len(self.consts) == 1 and not self.pts

    def consts_in(self, other: Value) -> bool:
        """Tell whether another value may be every constant that this one may be."""
        return other.consts is None or (self.consts is not None and self.consts <= other.consts)

    def texts(self) -> tuple[str, ...]:
        """Return the texts it may be, sorted; none when it may be another thing."""
        if self.consts is None or not all(isinstance(c, str) for c in self.consts):
            return ()
        return tuple(sorted(str(c) for c in self.consts))


BOTTOM = Value(consts=frozenset())
UNKNOWN = Value()
ABSENT = Value(consts=frozenset(["<absent>"]))  # a field that a new object does not have yet


def join(a: Value, b: Value) -> Value:
    """Return what is either; `a` itself when it covers `b`."""
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
    """Return the constants of either, None when there are too many."""
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
    """Return a value that is one object."""
    return Value(deps, frozenset([obj]))


def const(value: object) -> Value:
    """Return a value that is one constant; what cannot be hashed is anything."""
    try:
        return Value(consts=frozenset([value]))
    except TypeError:
        return UNKNOWN


@dataclass(slots=True, eq=False)
class ClassInfo:
    """A class of the analysed files. `opaque` when a base is not among them."""

    name: str
    qualname: str
    bases: list[Obj] = field(default_factory=list)
    external: list[str] = field(default_factory=list)
    statement: ir.Class | None = None
    module: str = ""
    fields: tuple[str, ...] = ()  # annotated in its body, as dataclasses have them
    named: bool = False  # a named tuple: its fields are its elements too

    @property
    def opaque(self) -> bool:
        """Tell whether code that is not analysed may see its instances' attributes and call its methods."""
        inherited = any(isinstance(b.info, ClassInfo) and b.info.opaque for b in self.bases)
        return inherited or any(not _plain(e) for e in self.external)


def inherited_from(value: Value) -> set[str]:
    """Return the classes that are not here and that objects of ours inherit from: a method may be theirs."""
    classes = {o.info for o in value.pts if o.kind == "instance" and isinstance(o.info, Obj)}
    infos = [c.info for cls in classes for c in lineage(cls)]
    return {e for i in infos if isinstance(i, ClassInfo) for e in i.external if "." in e and not _plain(e)}


def function_of(target: Obj) -> ir.Function | None:
    """Return the function of ours that a call of an object runs, None where nothing tells."""
    closure = target.info[0] if target.kind == "bound" and isinstance(target.info, tuple) else target
    found = closure.info[0] if closure.kind == "closure" and isinstance(closure.info, tuple) else None
    return found if isinstance(found, ir.Function) else None


def _plain(base: str) -> bool:
    """Tell whether a class of a library calls no methods that its heirs add: exceptions, containers, and the like."""
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
