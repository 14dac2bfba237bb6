"""Topological order of statements, ties and cycles by position."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping
from typing import TypeVar

from tarl_lint.model import Span

T = TypeVar("T", bound=int)


def in_order(spans: Mapping[T, Span], edges: Iterable[tuple[T, T]]) -> list[T]:
    """Return the keys so that `before` stands before `after` for each edge, where cycles allow it."""
    after: dict[T, set[T]] = {key: set() for key in spans}
    waiting = dict.fromkeys(spans, 0)
    for former, latter in edges:
        if former in after and latter in after and latter not in after[former] and former != latter:
            after[former].add(latter)
            waiting[latter] += 1
    ready = [(spans[key], key) for key, count in waiting.items() if not count]
    heapq.heapify(ready)
    left = dict(sorted(spans.items(), key=lambda item: item[1]))
    order: list[T] = []
    while left:
        key = heapq.heappop(ready)[1] if ready else next(iter(left))
        if key not in left:
            continue
        del left[key]
        order.append(key)
        for latter in after[key]:
            waiting[latter] -= 1
            if not waiting[latter] and latter in left:
                heapq.heappush(ready, (spans[latter], latter))
    return order
