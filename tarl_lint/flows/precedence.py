"""A relation that says which statements precede others; copying and extending it is cheap.

Every flow has a relation of its own. For each statement, the bits of an integer represent the statements that
precede it. Copies of a relation share these integers, and one operation unites two sets.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping


class Bits(dict[int, int]):
    """A table from keys to bits. A key gets the next free bit at its first use.

    Relations with common bits share one table.
    """

    def __init__(self) -> None:
        super().__init__()
        self.keys_of: list[int] = []  # number of a bit → its key

    def __missing__(self, key: int) -> int:
        """Return a new bit for a key."""
        bit = self[key] = 1 << len(self.keys_of)
        self.keys_of.append(key)
        return bit

    def union(self, keys: Iterable[int]) -> int:
        """Return the bits of some keys."""
        found = 0
        for key in keys:
            found |= self[key]
        return found


class Precedence:
    """A relation between keys. A key does not precede itself."""

    def __init__(self, pairs: Iterable[tuple[int, int]] = (), bits: Bits | None = None) -> None:
        """`bits` is a table of bits that other relations may use, too."""
        self.bits = Bits() if bits is None else bits
        self.before: dict[int, int] = {}  # key → bits of the keys that precede it
        self.update(pairs)

    def copy(self) -> Precedence:
        """Return an equal relation."""
        made = Precedence(bits=self.bits)
        made.before = {**self.before}
        return made

    def update(self, pairs: Iterable[tuple[int, int]]) -> None:
        """Add pairs of keys; the first key of a pair precedes the second."""
        for former, latter in pairs:
            self.add(self.bits[former], latter)

    def add(self, formers: int, latter: int) -> None:
        """Let a set of keys, given as bits, precede a key."""
        self.before[latter] = (self.before.get(latter, 0) | formers) & ~self.bits[latter]

    def add_ahead_of_loops(self, turns: Iterable[tuple[int, int]], function: Mapping[int, object]) -> None:
        """Order statements of other functions before the loops whose bodies use their values.

        Each pair in `turns` consists of a statement in the body of a loop and the head of this loop. The head uses
        a value that the statement computes in an earlier iteration.
        """
        heads: dict[int, int] = {}
        for carried, head in turns:
            heads[head] = heads.get(head, 0) | self.bits[carried]
        if not heads:
            return
        together: dict[int, int] = {}  # function → its statements
        for key, where in function.items():
            together[id(where)] = together.get(id(where), 0) | self.bits[key]
        known: dict[int, int] = {}
        ahead = {head: self._all_before(carried, known) for head, carried in heads.items()}
        for head, formers in ahead.items():
            self.add(formers & ~together.get(id(function.get(head)), 0), head)

    def _all_before(self, keys: int, known: dict[int, int]) -> int:
        """Return the bits of some keys and of all keys that precede them, directly or not.

        `known` maps the number of a key to the result for this key alone. The function adds results to it.
        """
        found = 0
        while left := keys & ~found:
            number = left.bit_length() - 1
            if number not in known:
                known[number] = self._before_one(number, known)
            found |= known[number]
        return found

    def _before_one(self, number: int, known: Mapping[int, int]) -> int:
        names, before = self.bits.keys_of, self.before
        finished = sum(1 << one for one in known)
        found = pending = 1 << number
        while pending:
            number = ((pending & finished) or pending).bit_length() - 1
            bit = 1 << number
            if pending & finished:
                found |= known[number]
                pending &= ~known[number]
            else:
                news = before.get(names[number], 0) & ~found
                found |= news
                pending ^= bit | news
        return found

    def formers(self, key: int) -> set[int]:
        """Return the keys that precede a key."""
        bits = self.before.get(key, 0)
        return {one for number, one in enumerate(self.bits.keys_of) if bits >> number & 1}

    def first_of(self, key: int, left: int) -> int | None:
        """Return a key before `key` that is in `left`, a set of keys given as bits; else None."""
        waiting = self.before.get(key, 0) & left
        return self.bits.keys_of[waiting.bit_length() - 1] if waiting else None
