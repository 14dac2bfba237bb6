"""What a call has read of the state, so that it need not run again as long as all of that is the same."""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass, field
from typing import Any

from tarl_lint.memory.values import Key, Obj, Value, join

Fact = tuple[Callable[[Any], object], object]  # a question and what it is asked of


@dataclass(slots=True, eq=False)
class Reads:
    """Reads of one running call, those of the calls that it makes included.

    Of the heap it holds only what was there when the call began: what a call reads after it has stored there
    itself is its own. Everything else only grows; it is noted as it was at the first look.
    """

    keys: set[Key] = field(default_factory=set)  # read by value
    stored: set[Key] = field(default_factory=set)  # asked whether the run has stored there
    written: set[Key] = field(default_factory=set)  # stored by the call on the path that is being followed
    objects: dict[Obj, int] = field(default_factory=dict)  # which fields, parts and data one has: its stamp
    unreached: set[int] = field(default_factory=set)  # nodes that no source led to
    held: dict[int, int] = field(default_factory=dict)  # carrier → how much it has passed on inside objects
    facts: dict[Fact, object] = field(default_factory=dict)
    whole: bool = True  # nothing was left out because too much was spent
    waits: bool = False
    heeds: int = 0  # how many places the root heeded at the first wait
    own: frozenset[Key] = frozenset()  # where the call had stored by then
    admitted: dict[Key, Value] = field(default_factory=dict)  # what came from others while it waited
    left: int = 0  # how often a path was left, so that what was written on it was not any more
    taken: dict[Reads, int] = field(default_factory=dict)  # reads that were taken over → `left` at that time

    def look(self, obj: Obj) -> None:
        """Note that it matters which fields and parts an object has, and whether data is in it."""
        if obj not in self.objects:
            self.objects[obj] = obj.stamp

    def ask(self, question: Callable[[Any], object], of: object) -> None:
        """Note that the present answer to a question matters."""
        if (question, of) not in self.facts:
            self.facts[question, of] = question(of)

    def wait(self, heeds: int, own: Set[Key] = frozenset()) -> None:
        """Note that others may see what is stored by now, and store themselves."""
        if not self.waits:
            self.waits, self.heeds = True, heeds
            self.own = frozenset(self.written | own)

    def admit(self, key: Key, value: Value) -> None:
        """Note what others may have stored."""
        known = self.admitted.get(key)
        self.admitted[key] = value if known is None else join(known, value)

    def add(self, inner: Reads) -> None:
        """Take over what a call has read that was made by this one."""
        if self.taken.get(inner) == self.left:
            return
        self.taken[inner] = self.left
        self.keys.update(inner.keys - self.written)
        self.stored.update(inner.stored - self.written)
        self.unreached |= inner.unreached
        for obj in inner.objects.keys() - self.objects.keys():
            self.objects[obj] = inner.objects[obj]
        for carrier in inner.held.keys() - self.held.keys():
            self.held[carrier] = inner.held[carrier]
        for fact in inner.facts.keys() - self.facts.keys():
            self.facts[fact] = inner.facts[fact]
        self.whole = self.whole and inner.whole
        if inner.waits:
            self.wait(inner.heeds, inner.own)
            for key, value in inner.admitted.items():
                self.admit(key, value)
