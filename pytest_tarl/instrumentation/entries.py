"""The list that instrumented code appends events to, a constant of its code objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any


class Entries(list[Any]):
    """Events of the one thread that runs the program: methods of `list`, which CPython calls without a frame.

    Code objects are compared, hashed, shown and pickled with their constants; so this one is equal to itself alone,
    has a short `repr`, and a copy in another process records nothing.
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
        """Show no event."""
        return "<events>"

    def __reduce__(self) -> tuple[type[Unheard], tuple[()]]:
        """Pickle as what drops every event."""
        return Unheard, ()


class SharedEntries(Entries):
    """The same once several threads run the program: an event goes to the entries of the running one.

    A list becomes this by its `__class__`, in one step, so that code which holds it need not change.
    """

    __slots__ = ()
    __hash__ = object.__hash__

    def append(self, entry: object, /) -> None:
        """Append half an event."""
        list.append(self.own(), entry)

    def extend(self, entries: Iterable[object], /) -> None:
        """Append several events."""
        list.extend(self.own(), entries)


class Unheard:
    """Stands for the events where nobody asks for them."""

    __slots__ = ()

    def append(self, entry: object, /) -> None:
        """Drop half an event."""

    def extend(self, entries: Iterable[object], /) -> None:
        """Drop several events."""
