"""Postdominators: the statements on every path from a statement to the end of its function.

After Cooper, Harvey and Kennedy (A Simple, Fast Dominance Algorithm, 2001), on reversed edges.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

EXIT: Final = 0


def postdominators(edges: Mapping[int, Mapping[str, int]], order: Sequence[int]) -> dict[int, int]:
    """Return for each statement its immediate postdominator.

    `edges` maps statements to their successors; `order` lists the statements.
    """
    before: dict[int, list[int]] = {}
    for node in order:
        for target in edges[node].values():
            before.setdefault(target, []).append(node)
    endless = _endless(before, order)
    before.setdefault(EXIT, []).extend(sorted(endless))
    finished = _finished(before)
    rank = {node: number for number, node in enumerate(finished)}
    nearest = {EXIT: EXIT}
    changed = True
    while changed:
        changed = False
        for node in reversed(finished[:-1]):
            targets = [t for t in edges[node].values() if t in nearest]
            if node in endless:
                targets.append(EXIT)
            common = targets[0]
            for target in targets[1:]:
                common = _meet(common, target, nearest, rank)
            if nearest.get(node) != common:
                nearest[node], changed = common, True
    return nearest


def _meet(one: int, other: int, nearest: Mapping[int, int], rank: Mapping[int, int]) -> int:
    """Return the nearest common postdominator of two statements."""
    while one != other:
        while rank[one] < rank[other]:
            one = nearest[one]
        while rank[other] < rank[one]:
            other = nearest[other]
    return one


def _endless(before: Mapping[int, Sequence[int]], order: Sequence[int]) -> set[int]:
    """Return statements to treat as final, so that every statement reaches the exit."""
    seen: set[int] = set()
    found: set[int] = set()
    pending = [EXIT]
    for last in (None, *reversed(order)):
        if last is not None and last not in seen:
            found.add(last)
            pending.append(last)
        while pending:
            node = pending.pop()
            if node not in seen:
                seen.add(node)
                pending += before.get(node, ())
    return found


def _finished(before: Mapping[int, Sequence[int]]) -> list[int]:
    """Return the statements in postorder of a depth-first walk from the exit along reversed edges."""
    finished: list[int] = []
    seen = {EXIT}
    path = [(EXIT, iter(before[EXIT]))]
    while path:
        node, rest = path[-1]
        following = next((n for n in rest if n not in seen), None)
        if following is None:
            finished.append(node)
            path.pop()
        else:
            seen.add(following)
            path.append((following, iter(before.get(following, ()))))
    return finished


def passed(start: int, end: int, nearest: Mapping[int, int]) -> Iterator[int]:
    """Yield the postdominators of one statement, up to another statement."""
    while start not in (end, EXIT):
        yield start
        start = nearest[start]
