"""Topological order of statements; ties and cycles are broken by position."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Mapping

from tarl_lint.flows.precedence import Precedence
from tarl_lint.model import Span


def in_order(
    spans: Mapping[int, Span], precedence: Precedence, first: Collection[int] | None = None
) -> list[int]:
    """Return the keys in an order after those that precede them, as far as cycles allow.

    A key without predecessors is placed as late as possible, except if it is in `first`. Without `first`, every key
    is placed as early as possible. Keys without a span are ignored.
    """
    left = dict(sorted(spans.items(), key=lambda item: item[1]))
    bits = precedence.bits.union(left)
    waiting: dict[
        int, list[int]
    ] = {}  # key → keys that wait for it; each key waits for one predecessor at a time
    ready: list[tuple[bool, Span, int]] = []
    for key, span in left.items():
        former = precedence.first_of(key, bits)
        if former is None:
            ready.append((first is not None and key not in first, span, key))
        else:
            waiting.setdefault(former, []).append(key)
    heapq.heapify(ready)
    order: list[int] = []
    while left:
        key = heapq.heappop(ready)[2] if ready else next(iter(left))
        if key not in left:
            continue
        del left[key]
        bits ^= precedence.bits[key]
        order.append(key)
        for latter in waiting.pop(key, ()):
            former = precedence.first_of(latter, bits)
            if former is not None:
                waiting.setdefault(former, []).append(latter)
            elif latter in left:
                heapq.heappush(ready, (False, spans[latter], latter))
    return order
