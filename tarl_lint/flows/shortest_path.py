"""Shortest path from a subscription to a publish call, counted in statements."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from itertools import chain


class ShortestPaths:
    """Shortest paths to one publish call. All subscriptions share the search, which goes on only as far as needed.

    A step to a node of the same statement, or to one without a statement, costs nothing (0-1 breadth-first search
    from the ends). The order of `ends` and `formers` breaks ties, so both must be ordered.

    The paths of a subscription consist of nodes that it reaches. The search need not be restricted to these nodes:
    everything to which a reached node leads is reached too, so a path from a subscription contains only nodes that
    the subscription reaches.
    """

    def __init__(
        self,
        ends: Iterable[int],
        formers: Callable[[int], Iterable[int]],
        statement_of: Callable[[int], int | None],
    ) -> None:
        self._statement_of = statement_of
        self._following: dict[int, int] = {}
        self._settled: dict[int, None] = {}  # nodes whose cost is final, cheapest first
        # the search does not refer to this object: a reference cycle would keep both in memory
        self._rest = _search(ends, formers, statement_of, self._following, self._settled)

    def path_from(self, starts: Set[int]) -> tuple[int, ...]:
        """Return the statements, in order, of a shortest path from one of `starts`; empty without one."""
        for node in chain(self._settled, self._rest):
            if node in starts:
                return _statements(node, self._following, self._statement_of)
        return ()


def _search(
    ends: Iterable[int],
    formers: Callable[[int], Iterable[int]],
    statement_of: Callable[[int], int | None],
    following: dict[int, int],
    settled: dict[int, None],
) -> Iterator[int]:
    """Yield nodes in order of final costs; `following` is the next node on a shortest path."""
    cost = dict.fromkeys(ends, 0)
    pending = deque(cost)
    while pending:
        node = pending.popleft()
        if node in settled:
            continue
        settled[node] = None
        here, so_far = statement_of(node), cost[node]
        for former in formers(node):
            step = statement_of(former)
            price = so_far + (step is not None and step != here)
            if price < cost.get(former, price + 1):
                cost[former] = price
                following[former] = node
                (pending.append if price > so_far else pending.appendleft)(former)
        yield node


def _statements(
    node: int, following: Mapping[int, int], statement_of: Callable[[int], int | None]
) -> tuple[int, ...]:
    """Return the statements along the path from a node, without repetition."""
    found: dict[int, None] = {}
    while True:
        if (statement := statement_of(node)) is not None:
            found[statement] = None
        if node not in following:
            return tuple(found)
        node = following[node]
