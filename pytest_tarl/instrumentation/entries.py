"""The lists that instrumented code appends its events to; code objects contain them as constants."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any


class Entries(list[Any]):
    """The events of a single-threaded program.

    Its methods are those of `list`, which CPython calls without a frame.

    Code objects are compared, hashed, printed and pickled together with their constants. This list is therefore equal
    only to itself and has a short `repr`. Unpickled in another process, it records nothing.
    """

    __slots__ = ("own",)
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, own: Callable[[], list[Any]]) -> None:
        super().__init__()
        self.own = own  # returns the entries of the running thread

    def __eq__(self, other: object) -> bool:
        """Compare by identity."""
        return self is other

    def __ne__(self, other: object) -> bool:
        """Compare by identity."""
        return self is not other

    def __repr__(self) -> str:
        """Return a short text without the events."""
        return "<events>"

    def __reduce__(self) -> tuple[type[Unheard], tuple[()]]:
        """Pickle as an object that drops every event."""
        return Unheard, ()


class SharedEntries(Entries):
    """The events of a multi-threaded program; each thread appends to its own list.

    An `Entries` list is converted by assigning to `__class__`, so code that refers to it stays valid.
    """

    __slots__ = ()
    __hash__ = object.__hash__

    def append(self, entry: object, /) -> None:
        """Append a site number or a value, which is half an event."""
        list.append(self.own(), entry)

    def extend(self, entries: Iterable[object], /) -> None:
        """Append several events."""
        list.extend(self.own(), entries)


class Unheard:
    """A list that drops all events, for a process that does not record."""

    __slots__ = ()

    def append(self, entry: object, /) -> None:
        """Drop a site number or a value."""

    def extend(self, entries: Iterable[object], /) -> None:
        """Drop several events."""
