"""Tells apart the sources at one line, which a helper class registers for others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import reduce

from tarl_lint.model import Flow
from tarl_lint.models.ros.endpoints import SourceRecord


def told_apart(records: Iterable[SourceRecord]) -> list[SourceRecord]:
    """Return one source for each line and its topics.

    A record is merged into another one of its line if the other has all its topics and more: the analysis may have
    reached the line before it knew the names. If a record has no topic, both must be of one call context.
    """
    found: list[SourceRecord] = []
    for same in by_line(records):
        heads = [one for one in same if not any(_outgrown(one, other) for other in same)]
        groups = [[one] for one in heads]
        for one in same:
            if one not in heads:
                for group in groups:
                    if _outgrown(one, group[0]):
                        group.append(one)
        found += map(merged, groups)
    return found


def named_first(flows: Iterable[Flow]) -> Iterator[Flow]:
    """Yield the flows into one sink, but of the sources at one line those without topics only if they tell more.

    A class that registers sources may also be analysed without a caller, and then its topics are unknown.
    """
    found = list(flows)
    kinds: dict[object, set[str]] = {}
    for flow in found:
        if flow.source.topics:
            kinds.setdefault((flow.source.span, flow.source.api), set()).add(flow.kind)
    for flow in found:
        known = kinds.get((flow.source.span, flow.source.api), set())
        if flow.source.topics or known.isdisjoint({flow.kind, "explicit"}):
            yield flow


def by_line(records: Iterable[SourceRecord]) -> Sequence[Sequence[SourceRecord]]:
    """Return the records of each registration: those of one call, as one kind of source."""
    groups: dict[object, list[SourceRecord]] = {}
    for record in records:
        groups.setdefault((record.path, record.pos, record.api, record.kind), []).append(record)
    return list(groups.values())


def _outgrown(record: SourceRecord, other: SourceRecord) -> bool:
    """Return whether another record has all topics of a record, and more."""
    return record.topics < other.topics and bool(record.topics or record.contexts & other.contexts)


def merged(records: Sequence[SourceRecord]) -> SourceRecord:
    """Return the records of one line as one source; it stands where the first of them stands."""
    return reduce(_merged, records)


def _merged(one: SourceRecord, other: SourceRecord) -> SourceRecord:
    return replace(
        one,
        topics=one.topics | other.topics,
        types=one.types | other.types,
        whole_types=one.whole_types | other.whole_types,
        callbacks=one.callbacks | other.callbacks,
        nodes=one.nodes | other.nodes,
        registered=one.registered | other.registered,
        via=one.via | other.via,
        messages={**one.messages, **other.messages},
        contexts=one.contexts | other.contexts,
    )
