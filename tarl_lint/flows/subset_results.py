"""Results for sets of nodes; each result is extended from the known result for a large subset.

Most flows of a program share most of their nodes, even if they end in different publish calls.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Set
from typing import Final, Generic, Protocol, TypeVar

# a subset gets its own stored result if it has at least this many more nodes than every subset with a stored result
WORTHWHILE: Final = 500
MAX_KEPT: Final = 8  # maximum number of results that are kept


class OfNodes(Protocol):
    """A result for a set of nodes."""

    @property
    def nodes(self) -> Set[int]:
        """The set of nodes."""


T = TypeVar("T", bound=OfNodes)


class Nearest(Generic[T]):
    """Keeps results for subsets of the sets that were requested."""

    def __init__(self, empty: T, extended: Callable[[Set[int], T], T], worthwhile: int = WORTHWHILE) -> None:
        """`extended(nodes, known)` returns the result for some nodes, given the result for the subset `known`."""
        self._empty = empty
        self._extended = extended
        self._worthwhile = worthwhile
        self._kept: list[T] = []
        # kind of result → the last set of nodes for which it was computed
        self._last: dict[Hashable, Set[int]] = {}

    def of(self, nodes: Set[int], kind: Hashable, *more: T) -> T:
        """Return the result for some nodes; `more` holds known results for subsets of the nodes.

        Sets of one kind, such as those of one source, share most of their nodes. `nodes` is kept, so the caller
        must not change it later.
        """
        known = self._largest_inside(nodes, more)
        last = self._last.get(kind, frozenset())
        self._last[kind] = nodes
        least = len(known.nodes) + self._worthwhile
        if len(last) > least and len(shared := last & nodes) > least:
            known = self._extended(shared, self._largest_inside(shared, more))
            self._kept = [*self._kept[1 - MAX_KEPT :], known]
        return self._extended(nodes, known)

    def _largest_inside(self, nodes: Set[int], more: Iterable[T]) -> T:
        """Return the known result for the largest subset of some nodes."""
        found = self._empty
        for one in (*more, *self._kept):
            if len(one.nodes) > len(found.nodes) and one.nodes <= nodes:
                found = one
        return found
