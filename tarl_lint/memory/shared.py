"""The stores of all roots: the values left for other roots, and the roots that read them."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Final

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import DATA, Key, Obj, Value, join

BORN: Final = "<born>"  # pseudo-field that marks an existing object


@dataclass(slots=True, eq=False)
class Root:
    """A unit of the worklist: a module, callback, timer, thread or entry point.

    If `once` is True, the root never runs concurrently with itself.
    """

    key: Hashable
    kind: str
    name: str = ""
    once: bool = False
    function: ir.Function | None = None  # the function that the root runs; None if unknown
    maker: Root | None = None  # the root whose run added this root
    program: str = ""  # the file whose budget the root uses
    number: int = 0  # position of the root in the order of addition
    # keys to which the root stores and which it reads again after a wait
    heeds: set[Key] = field(default_factory=set)

    def generations(self) -> int:
        """Return the number of ancestors with the same function; `maker` is the parent of a root."""
        count, maker = 0, self.maker
        while maker is not None:
            count += maker.function is self.function
            maker = maker.maker
        return count


NOBODY: set[Root] = set()


@dataclass(slots=True)
class Shared:
    """The values that the roots have stored: at their ends (`ends`), and at their waits (`pauses`)."""

    ends: dict[Key, dict[Root, Value]] = field(default_factory=dict)
    pauses: dict[Key, dict[Root, Value]] = field(default_factory=dict)
    readers: dict[Key, set[Root]] = field(default_factory=dict)
    joiners: dict[Key, set[Root]] = field(default_factory=dict)  # key → roots that only joined its value
    watchers: dict[Obj, set[Root]] = field(default_factory=dict)
    # object → roots that found no data inside the object
    doubters: dict[Obj, set[Root]] = field(default_factory=dict)
    # object → roots that have relied on the object being a single concrete one, in order
    certain: dict[Obj, dict[Root, None]] = field(default_factory=dict)
    several: set[Obj] = field(default_factory=set)  # objects that now stand for several concrete ones
    dirty: set[Root] = field(default_factory=set)
    # key → the tuple that all records of calls share for the key; otherwise each read would store its own tuple
    one: dict[Key, Key] = field(default_factory=dict)
    loaded: int = 0  # number of objects that turned out to hold data
    edition: int = 0  # number of changes so far to a class, a `from … import *` or a `__dict__`

    def read(self, key: Key, root: Root) -> None:
        """Register a root as reader of a key."""
        readers = self.readers.get(key)
        if readers is None:
            readers = self.readers[key] = set()
        readers.add(root)

    def entry(self, key: Key, root: Root, *, joining: bool = False) -> Value | None:
        """Return the initial value of a key for a root: the join of the stores of all other roots.

        With `joining`, the root's own stores do not make the root run again.
        """
        if joining:
            self.joiners.setdefault(key, set()).add(root)
        else:
            self.read(key, root)
        result: Value | None = None
        ends = self.ends.get(key)
        if ends is not None:
            for owner, value in ends.items():
                if owner is not root or not root.once:
                    result = value if result is None else join(result, value)
        pauses = self.pauses.get(key)
        if pauses is not None:
            for owner, value in pauses.items():
                if owner is not root:
                    result = value if result is None else join(result, value)
        return result

    def others(self, key: Key, root: Root) -> Value | None:
        """Return the join of the stores that other roots may make while this root waits."""
        result: Value | None = None
        for table in (self.ends, self.pauses):
            for owner, value in table.get(key, {}).items():
                if owner is not root:
                    result = value if result is None else join(result, value)
        self.readers.setdefault(key, set()).add(root)
        return result

    def look(self, obj: Obj, root: Root) -> None:
        """Register a root as reader of the set of an object's fields."""
        self.watchers.setdefault(obj, set()).add(root)

    def load(self, obj: Obj, root: Root) -> None:
        """Mark an object, and all objects that contain it, as holding data."""
        pending = [obj]
        while pending:
            current = pending.pop()
            if current.laden:
                continue
            current.laden = True
            self.loaded += 1
            current.changed(DATA)
            self.dirty |= self._others(self.doubters.pop(current, None), root)
            pending += current.inside
            pending += current.subs.values()
            pending += [current.parent] if current.parent is not None else []
            current.inside.clear()

    def _appeared(self, obj: Obj, root: Root) -> None:
        """Re-run the roots that have read the set of fields of this object, or of an enclosing object."""
        inside: Obj | None = obj
        while inside is not None:
            self.dirty |= self._others(self.watchers.get(inside), root)
            inside = inside.parent

    def _others(self, roots: set[Root] | None, root: Root) -> set[Root]:
        """Return the readers to notify of a root's change.

        The root itself is among the readers only if it can run concurrently with itself.
        """
        if not roots:
            return NOBODY
        return roots - {root} if root.once else roots

    def leave(self, table: dict[Key, dict[Root, Value]], root: Root, key: Key, value: Value) -> None:
        """Store a root's value in a table; if the value changed, mark the roots that read it as dirty."""
        owners = table.setdefault(key, {})
        before = owners.get(root)
        after = value if before is None else join(before, value)
        # readers of the object have also read the field that holds it, and are notified through that field
        if key[1] == BORN:
            owners[root] = after
            return
        if not owners:
            self._appeared(key[0], root)
        if before is None or after != before:
            owners[root] = after
            self.dirty |= self._others(self.readers.get(key), root)
            joiners = self.joiners.get(key)
            if joiners:
                self.dirty |= joiners - {root}
