"""The event lists to which instrumented code appends. Code objects hold them as constants."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any


class Entries(list[Any]):
    """Events of a single-threaded program.

    The class inherits the methods of `list`, which CPython calls without a frame.

    Code objects are compared, hashed, printed and pickled together with their constants. Therefore this list is equal
    only to itself, has a short `repr`, and its unpickled copy in another process records nothing.
    """

    __slots__ = ("own",)
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, own: Callable[[], list[Any]]) -> None:
        super().__init__()
        self.own = own  # returns the running thread's entries

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
    """Events of a multi-threaded program: events are appended to the list of the thread that runs.

    Assigning `__class__` converts an `Entries` list to this class, so code that refers to the list remains valid.
    """

    __slots__ = ()
    __hash__ = object.__hash__

    def append(self, entry: object, /) -> None:
        """Append half an event: a site number or a value."""
        list.append(self.own(), entry)

    def extend(self, entries: Iterable[object], /) -> None:
        """Append several events."""
        list.extend(self.own(), entries)


class Unheard:
    """An event list that drops all events, for a process that does not record."""

    __slots__ = ()

    def append(self, entry: object, /) -> None:
        """Drop half an event."""

    def extend(self, entries: Iterable[object], /) -> None:
        """Drop several events."""
