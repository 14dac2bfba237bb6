"""Flows across nodes: chains of hops, each of which begins at the topic where the previous one ends."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.system.compose import UNKNOWN
from tarl_lint.system.model import Chain, Hop

MOST: Final = 200  # maximum number of chains of one system
STEPS: Final = 100_000  # maximum number of steps of the search


def chains(
    hops: Sequence[Hop], origin: str = "", target: str = "", *, every: bool = False
) -> tuple[tuple[Chain, ...], bool]:
    """Return the chains between two topics, at most `MOST` unless `every`, and whether there may be more chains.

    Without `origin`, chains begin where data enters the analysed nodes. Without `target`, they end where data leaves
    these nodes. A chain passes each topic once.
    """
    hops = [
        hop for hop in hops if hop.source != hop.sink
    ]  # a hop from a topic to itself would hide chains that end at the topic
    from_topic: dict[str, list[Hop]] = {}
    for hop in hops:
        from_topic.setdefault(hop.source, []).append(hop)
    starts = [slashed(origin)] if origin else _first(hops)
    wanted = {slashed(target)} if target else _last(hops)
    leading = _leading(hops, wanted)
    found: list[Chain] = []
    for chain in _walk(from_topic, starts, wanted, leading):
        if chain is None or (len(found) >= MOST and not every):
            return tuple(found), True
        found.append(chain)
    return tuple(sorted(found, key=lambda c: [(h.source, h.node, h.sink) for h in c.hops])), False


def shown_chains(hops: Sequence[Hop], origin: str, target: str, most: int) -> tuple[tuple[Chain, ...], bool]:
    """Return the chains between two topics, for a format that shows `most` (0: all), and whether there may be more."""
    return chains(hops, origin, target, every=most == 0 or most > MOST)


def limited(found: Sequence[Chain], most: int, *, more: bool) -> tuple[Sequence[Chain], str]:
    """Return at most `most` chains (0: all), and a remark on the chains left out; "" if there are none.

    `more` means that the search ended before it had found all chains.
    """
    shown = found[:most] if most else found
    rest = len(found) - len(shown)
    if not (rest or more):
        return shown, ""
    least = "more than " if more else ""
    number = f"{least}{rest} more flow{'' if rest == 1 else 's'}" if rest else "more"
    way = "" if more and not most else ", or show all with --max-paths 0"
    return shown, f"… and {number}: select them with --from and --to{way}."


def _first(hops: Sequence[Hop]) -> list[str]:
    """Return the topics at which flows begin; all topics if there are only cycles."""
    sources = {hop.source for hop in hops}
    return sorted(_ends(sources, [(hop.sink, hop.source, hop.kind != "not read") for hop in hops]) or sources)


def _last(hops: Sequence[Hop]) -> set[str]:
    """Return the topics at which flows end; all topics if there are only cycles."""
    sinks = {hop.sink for hop in hops}
    return (_ends(sinks, [(hop.source, hop.sink, hop.kind != "not read") for hop in hops]) or sinks) | {
        UNKNOWN
    }


def _ends(topics: set[str], edges: Sequence[tuple[str, str, bool]]) -> set[str]:
    """Return the topics without successors, and the topics on a cycle whose edges all belong to unread nodes."""
    after: dict[str, set[str]] = {}
    for one, other, _ in edges:
        after.setdefault(one, set()).add(other)
    read = {one for one, _, certain in edges if certain}
    return {one for one in topics if one not in after or (one not in read and _returns(one, after))} | (
        topics & {UNKNOWN}
    )


def _returns(topic: str, after: Mapping[str, set[str]]) -> bool:
    found: set[str] = set()
    pending = list(after.get(topic, ()))
    while pending:
        one = pending.pop()
        if one not in found:
            found.add(one)
            pending += after.get(one, ())
    return topic in found


def slashed(topic: str) -> str:
    """Return the user's topic as an absolute name."""
    return topic if topic.startswith("/") else f"/{topic}"


def _leading(hops: Iterable[Hop], wanted: set[str]) -> set[str]:
    """Return the topics from which hops lead to the target."""
    before: dict[str, set[str]] = {}
    for hop in hops:
        before.setdefault(hop.sink, set()).add(hop.source)
    found, pending = set(wanted), list(wanted)
    while pending:
        for topic in before.get(pending.pop(), set()) - found:
            if topic != UNKNOWN:
                pending.append(topic)
            found.add(topic)
    return found


def _walk(
    from_topic: dict[str, list[Hop]], starts: Sequence[str], wanted: set[str], leading: set[str]
) -> Iterator[Chain | None]:
    """Yield the chains; then None if the search ends early."""
    steps = 0
    for start in starts:
        pending: list[tuple[Hop, ...]] = [(hop,) for hop in reversed(from_topic.get(start, ()))]
        while pending and steps < STEPS:
            steps += 1
            path = pending.pop()
            last = path[-1].sink
            if last in wanted:
                yield Chain(path)
                if last == UNKNOWN or last not in from_topic:
                    continue
            if last == UNKNOWN or last not in leading:
                continue
            passed = {start, *(hop.sink for hop in path)} - {UNKNOWN}
            pending += [
                (*path, hop)
                for hop in reversed(from_topic.get(last, ()))
                if hop.sink not in passed and not any(hop.excludes(one) for one in path)
            ]
        if pending:
            yield None
            return
