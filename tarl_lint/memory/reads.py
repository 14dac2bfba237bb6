"""The reads of a call: while all of them are unchanged, the call can be replayed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass, field
from typing import Any, Final, TypeVar

from tarl_lint.memory.values import Key, Obj, Value, join

NEW: Final = -1  # stamp recorded for an object that did not exist yet
T = TypeVar("T")
U = TypeVar("U")
Fact = tuple[Callable[[Any], object], object]  # (function, its argument)


@dataclass(slots=True, eq=False)
class Reads:
    """The reads of a running call, including those of nested calls.

    A heap read counts only if the call has not stored to the key before. All other facts can only grow. The value
    at the first read is recorded.
    """

    keys: set[Key] = field(default_factory=set)  # keys whose value was read
    # keys for which the call asked whether the run has stored to them
    stored: set[Key] = field(default_factory=set)
    # `keys` and `stored` once the call has finished; the sets themselves are then empty
    finished: tuple[Set[Key], Set[Key]] | None = None
    written: set[Key] = field(default_factory=set)  # keys to which the call has stored on the current path
    objects: dict[Obj, int] = field(
        default_factory=dict
    )  # object → its stamp (version of its fields, parts and data)
    single: set[Obj] = field(default_factory=set)  # objects that the call treated as one concrete object
    # nodes that no source had reached when the call used them
    unreached: set[int] = field(default_factory=set)
    holders: dict[Obj, int] = field(
        default_factory=dict
    )  # object → number of keys that have ever held a pointer to the object
    held: dict[int, int] = field(
        default_factory=dict
    )  # carrier → number of nodes that the carrier has passed on inside objects
    arrivals: set[object] = field(
        default_factory=set
    )  # cached results whose `consulted` carriers are already in `held`
    facts: dict[Fact, object] = field(default_factory=dict)
    whole: bool = True  # whether the call ran to its end; False if a budget limit cut it short
    waits: bool = False
    heard: int = 0  # number of keys for which the first wait takes in values from other roots
    own: frozenset[Key] = frozenset()  # keys that the call had stored by the first wait
    # key → value that the call took in from other roots at its waits
    admitted: dict[Key, Value] = field(default_factory=dict)
    # number of paths that the call has left so far; stores on these paths no longer count as `written`
    left: int = 0
    # merged reads → value of `left` when they were merged
    taken: dict[Reads, int] = field(default_factory=dict)

    def look(self, obj: Obj) -> None:
        """Record a dependency on an object's stamp: its fields, parts and data."""
        if obj not in self.objects:
            self.objects[obj] = obj.stamp

    def ask(self, question: Callable[[Any], object], of: object) -> None:
        """Record a dependency on the current result of `question(of)`."""
        if (question, of) not in self.facts:
            self.facts[question, of] = question(of)

    def wait(self, heard: int, own: Set[Key] = frozenset()) -> None:
        """Record a wait, during which other roots see the stores made so far and can store values themselves."""
        if not self.waits:
            self.waits, self.heard = True, heard
            self.own = frozenset(self.written | own)

    def admit(self, key: Key, value: Value) -> None:
        """Record a value that other roots may have stored."""
        known = self.admitted.get(key)
        self.admitted[key] = value if known is None else join(known, value)

    def add(self, inner: Reads) -> None:
        """Merge the reads of a nested call."""
        taken = self.taken.get(inner)
        if taken == self.left:
            return
        self.taken[inner] = self.left
        keys, stored = inner.finished or (inner.keys, inner.stored)
        self.keys.update(keys - self.written)
        self.stored.update(stored - self.written)
        if taken is None:
            self._add_rest(inner)

    def finish(self, keys: Set[Key], stored: Set[Key]) -> None:
        """Drop everything that is needed only while the call runs.

        `keys` and `stored` equal the sets with these names. They share the memory of a table that is kept anyway.
        `taken` is dropped because it would keep the reads of earlier runs in memory.
        """
        self.finished = keys, stored
        self.keys, self.stored = set(), set()
        self.taken, self.arrivals, self.written = {}, set(), set()

    def _add_rest(self, inner: Reads) -> None:
        """Merge the reads that do not depend on the current path; this is needed only once."""
        self.unreached |= inner.unreached
        self.single |= inner.single
        complete(self.objects, inner.objects)
        if inner.holders:
            complete(self.holders, inner.holders)
        if inner.held:
            complete(self.held, inner.held)
        if inner.facts:
            complete(self.facts, inner.facts)
        self.whole = self.whole and inner.whole
        if inner.waits:
            self.wait(inner.heard, inner.own)
            for key, value in inner.admitted.items():
                self.admit(key, value)


def complete(mine: dict[T, U], theirs: Mapping[T, U]) -> None:
    """Add the entries of `theirs` that are missing.

    The time is proportional to the size of `theirs`, which is usually the smaller mapping.
    """
    if not mine:
        mine.update(theirs)
    elif not theirs.keys() <= mine.keys():
        for key, value in theirs.items():
            if key not in mine:
                mine[key] = value
