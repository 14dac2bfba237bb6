"""Shortest path from a subscription to a publish call, counted in statements."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping


def shortest_path(
    ends: Iterable[int],
    starts: set[int],
    formers: Callable[[int], Iterable[int]],
    statement_of: Mapping[int, int],
) -> tuple[int, ...]:
    """Return the statements on a shortest path from one of `starts` to one of `ends`, in order.

    A step to a node of the same statement, or to one without a statement, costs nothing (0-1 breadth-first search
    from the ends). The order of `ends` and `formers` breaks ties, so both must be ordered. Empty if there is no path.
    """
    following: dict[int, int] = {}
    cost: dict[int, int] = {}
    pending: deque[int] = deque()
    for node in ends:
        if node not in cost:
            cost[node] = 0
            pending.append(node)
    settled: set[int] = set()
    while pending:
        node = pending.popleft()
        if node in settled:
            continue
        settled.add(node)
        if node in starts:
            return _statements(node, following, statement_of)
        for former in formers(node):
            step = statement_of.get(former)
            price = cost[node] + (step is not None and step != statement_of.get(node))
            if price < cost.get(former, price + 1):
                cost[former] = price
                following[former] = node
                (pending.append if price > cost[node] else pending.appendleft)(former)
    return ()


def _statements(node: int, following: Mapping[int, int], statement_of: Mapping[int, int]) -> tuple[int, ...]:
    """Return the statements along the path from a node, without repetition."""
    found: dict[int, None] = {}
    while True:
        if (statement := statement_of.get(node)) is not None:
            found[statement] = None
        if node not in following:
            return tuple(found)
        node = following[node]
