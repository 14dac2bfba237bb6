"""Sources and sinks in the form of the public model."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from tarl_lint.flows.statement_text import Texts
from tarl_lint.model import Sink, Source, Span
from tarl_lint.models.ros.endpoints import DefaultName, SinkRecord, SourceRecord


@dataclass(frozen=True, eq=False)
class Ends:
    """Describes the ends of flows.

    Sinks with the same topics are numbered, and the name of a sink contains its number.
    """

    texts: Texts
    sinks: Collection[SinkRecord]

    def source(self, record: SourceRecord) -> Source:
        """Return a source in the form of the public model."""
        topics = tuple(sorted(map(str, record.topics)))
        callback = ", ".join(sorted(record.callbacks))
        name = ", ".join(topics) or f"line {record.pos[0]}"
        return Source(
            id=f"{record.module}:{record.qualname or '<module>'}:{name}:{callback or record.api}",
            span=self._span(record.path, record.pos),
            topics=topics,
            type=" | ".join(sorted(record.types)),
            callback=callback,
            api=record.api,
            registered=self._spans(record.registered or {(record.path, record.pos)}),
            via=self._spans(record.via),
            module=record.module,
            qualname=record.qualname,
            default_topics=_defaults(record.topics),
        )

    def sink(self, record: SinkRecord) -> Sink:
        """Return a sink in the form of the public model."""
        topics = tuple(sorted(map(str, record.topics)))
        name = ", ".join(topics) or f"line {record.pos[0]}"
        same = sorted(r.pos for r in self.sinks if (r.module, r.qualname, r.topics) == _kin(record))
        ordinal = f"#{same.index(record.pos) + 1}" if len(same) > 1 else ""
        return Sink(
            id=f"{record.module}:{record.qualname or '<module>'}:{name}{ordinal}",
            span=self._span(record.path, record.pos),
            topics=topics,
            type=" | ".join(sorted(record.types)),
            api=record.api,
            module=record.module,
            qualname=record.qualname,
            default_topics=_defaults(record.topics),
        )

    def _span(self, path: str, pos: tuple[int, int, int, int]) -> Span:
        return self.texts[path].stretch(pos)

    def _spans(self, places: set[tuple[str, tuple[int, int, int, int]]]) -> tuple[Span, ...]:
        return tuple(sorted(self._span(*p) for p in places))


def _defaults(topics: Collection[str]) -> tuple[str, ...]:
    return tuple(sorted(str(topic) for topic in topics if isinstance(topic, DefaultName)))


def _kin(record: SinkRecord) -> tuple[str, str, set[str]]:
    return record.module, record.qualname, record.topics
