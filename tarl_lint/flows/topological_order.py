"""Topological order of statements; ties and cycles are broken by position."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable, Mapping
from typing import TypeVar

from tarl_lint.model import Span

T = TypeVar("T", bound=int)


def in_order(
    spans: Mapping[T, Span], edges: Iterable[tuple[T, T]], first: Collection[T] | None = None
) -> list[T]:
    """Return the keys in an order in which `before` precedes `after` for each edge, as far as cycles allow.

    A key without predecessors is placed as late as possible, unless it is in `first`. Without `first`, every
    key is placed as early as possible.
    """
    after: dict[T, set[T]] = {key: set() for key in spans}
    waiting = dict.fromkeys(spans, 0)
    for former, latter in edges:
        if former in after and latter in after and latter not in after[former] and former != latter:
            after[former].add(latter)
            waiting[latter] += 1
    ready = [
        (first is not None and key not in first, spans[key], key)
        for key, count in waiting.items()
        if not count
    ]
    heapq.heapify(ready)
    left = dict(sorted(spans.items(), key=lambda item: item[1]))
    order: list[T] = []
    while left:
        key = heapq.heappop(ready)[2] if ready else next(iter(left))
        if key not in left:
            continue
        del left[key]
        order.append(key)
        for latter in after[key]:
            waiting[latter] -= 1
            if not waiting[latter] and latter in left:
                heapq.heappush(ready, (False, spans[latter], latter))
    return order


def before_loops(
    edges: Iterable[tuple[int, int]], turns: Iterable[tuple[int, int]], function: Mapping[int, object]
) -> list[tuple[int, int]]:
    """Return edges that order statements of other functions before a loop.

    Such a statement computes a value that the loop's body uses, so it comes before the loop's head.
    """
    heads: dict[int, set[int]] = {}
    for carried, head in turns:
        heads.setdefault(head, set()).add(carried)
    if not heads:
        return []
    formers: dict[int, list[int]] = {}
    for before, after in edges:
        formers.setdefault(after, []).append(before)
    found: list[tuple[int, int]] = []
    for head, carried_to in heads.items():
        seen, pending = set(carried_to), list(carried_to)
        while pending:
            for before in formers.get(pending.pop(), ()):
                if before not in seen:
                    seen.add(before)
                    pending.append(before)
        found += [(s, head) for s in seen if function.get(s) is not function.get(head)]
    return found
