"""Distinguish the sources, or sinks, at one line: a helper class may subscribe or publish there for several others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import reduce
from typing import TypeVar

from tarl_lint.model import Flow
from tarl_lint.models.ros.endpoints import SinkRecord, SourceRecord

Record = TypeVar("Record", SourceRecord, SinkRecord)


def told_apart(records: Iterable[Record]) -> list[Record]:
    """Return one source, or one sink, for each combination of a line and topics.

    A record is merged into another record of the same line if the other record has all its topics and further ones,
    because the analysis may have reached the line before it knew all names. If one of the two records has no topic,
    both must belong to the same call context.
    """
    found: list[Record] = []
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


def sinks_told_apart(records: Iterable[SinkRecord]) -> list[SinkRecord]:
    """Return one sink for each combination of a line and topics.

    Publishers that publish in the same call contexts are merged into one sink.
    """
    alike: dict[object, list[SinkRecord]] = {}
    for record in records:
        alike.setdefault((record.path, record.pos, frozenset(record.contexts)), []).append(record)
    groups: dict[object, list[SinkRecord]] = {}
    for record in map(merged, alike.values()):
        groups.setdefault((record.path, record.pos, frozenset(record.topics)), []).append(record)
    return told_apart(map(merged, groups.values()))


def named_first(flows: Iterable[Flow]) -> Iterator[Flow]:
    """Yield the flows into a sink, without flows from topicless sources that add nothing.

    A class that registers sources may also be analysed without a caller, and then the topics of its sources are
    unknown.
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


def named_sinks_first(flows: Iterable[Flow]) -> Iterator[Flow]:
    """Yield flows; omit one into a topicless sink if it also enters a sink with topics.

    Both sinks are at the same place, and both flows have the same source. An explicit flow may replace an implicit
    one.
    """
    found = list(flows)
    kinds: dict[object, set[str]] = {}
    for flow in found:
        if flow.sink.topics:
            kinds.setdefault((flow.sink.span, flow.source), set()).add(flow.kind)
    for flow in found:
        known = kinds.get((flow.sink.span, flow.source), set())
        if flow.sink.topics or known.isdisjoint({flow.kind, "explicit"}):
            yield flow


def by_line(records: Iterable[Record]) -> Sequence[Sequence[Record]]:
    """Return the records of each call, by line; one registration may belong to several kinds of sources."""
    groups: dict[object, list[Record]] = {}
    for record in records:
        kind = (record.api, record.kind) if isinstance(record, SourceRecord) else None
        groups.setdefault((record.path, record.pos, kind), []).append(record)
    return list(groups.values())


def _outgrown(record: Record, other: Record) -> bool:
    """Return whether some other record has all topics of this record, and further ones."""
    return record.topics < other.topics and bool(record.topics or record.contexts & other.contexts)


def merged(records: Sequence[Record]) -> Record:
    """Return the records of one line as one source or sink, in the place of the first record."""
    return reduce(_merged, records)


def _merged(one: Record, other: Record) -> Record:
    if isinstance(one, SinkRecord):
        return replace(
            one,
            topics=one.topics | other.topics,
            types=one.types | other.types,
            nodes=one.nodes | other.nodes,
            publishers=one.publishers | other.publishers,
            contexts=one.contexts | other.contexts,
        )
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
