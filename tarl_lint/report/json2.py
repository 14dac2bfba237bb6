"""JSON report for large trees: each statement occurs once, and flows refer to it by number."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeVar

from tarl_lint import __version__
from tarl_lint.model import Finding, Flow, Sink, Source, Span, Step
from tarl_lint.report import closing_lines
from tarl_lint.report.json import incomplete
from tarl_lint.report.line import Line, View, plain
from tarl_lint.run.runner import Result

FORMAT_VERSION: Final = 2  # 2: numbered statements, sources and sinks, packages, shortest chains

T = TypeVar("T")
Table = dict[T, int]


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the document in ASCII, with one statement, source, sink or diagnostic per line."""
    yield from in_lines(document(result))


def in_lines(parts: Mapping[str, Any]) -> Iterator[Line]:
    """Yield a document in ASCII, with one item of its lists per line."""
    yield (("{", ""),)
    last = list(parts)[-1]
    for key, value in parts.items():
        comma = "" if key == last else ","
        if not isinstance(value, list) or not value:
            yield ((f"{json.dumps(key)}:{_dumped(value)}{comma}", ""),)
            continue
        yield ((f"{json.dumps(key)}:[", ""),)
        for item in value[:-1]:
            yield ((f"{_dumped(item)},", ""),)
        yield ((f"{_dumped(value[-1])}]{comma}", ""),)
    yield (("}", ""),)


def document(result: Result) -> dict[str, Any]:
    """Return all findings, including accepted flows, in the order of `findings2.schema.json`."""
    steps: Table[Step] = {}
    sources: Table[Source] = {}
    sinks: Table[Sink] = {}
    diagnostics = [_diagnostic(finding, steps, sources, sinks) for finding in result.findings]
    return {
        "format": FORMAT_VERSION,
        "tool": {"name": "tarl-lint", "version": __version__},
        "files": result.statistics.files,
        "notes": [plain(line) for line in closing_lines.not_analysed(result)],
        "errors": [{"path": e.path, "line": e.line, "message": e.message} for e in result.errors],
        **incomplete(result),
        **_outside(result),
        "steps": [_step(step) for step in steps],
        "sources": [_source(source) for source in sources],
        "sinks": [_sink(sink) for sink in sinks],
        "diagnostics": diagnostics,
    }


def _outside(result: Result) -> dict[str, Any]:
    """Return the analysed installed packages and the classes at which flows ended; empty keys are left out."""
    found = {"followed": list(result.followed), "opaque": list(result.ended)}
    return {key: names for key, names in found.items() if names}


def _dumped(value: object) -> str:
    return json.dumps(value, separators=(",", ":"))


def _number(table: Table[T], item: T) -> int:
    return table.setdefault(item, len(table))


def _diagnostic(
    finding: Finding, steps: Table[Step], sources: Table[Source], sinks: Table[Sink]
) -> dict[str, Any]:
    flow = {"flow": _flow(finding.flow, steps, sources, sinks)} if finding.flow else _extent(finding.span)
    return {
        "code": finding.code,
        "message": finding.message,
        "package": finding.package,
        "fingerprint": finding.fingerprint,
        "status": finding.status,
        **flow,
    }


def _flow(flow: Flow, steps: Table[Step], sources: Table[Source], sinks: Table[Sink]) -> dict[str, Any]:
    """Return a flow by numbers; `chain` contains indices into the flow's `steps`."""
    return {
        "kind": flow.kind,
        "source": _number(sources, flow.source),
        "sink": _number(sinks, flow.sink),
        "steps": [_number(steps, step) for step in flow.steps],
        "chain": list(flow.chain),
    }


def _source(source: Source) -> dict[str, Any]:
    return {
        "id": source.id,
        **_extent(source.span),
        "topics": list(source.topics),
        **({"defaultTopics": list(source.default_topics)} if source.default_topics else {}),
        "type": source.type,
        "callback": source.callback,
        "api": source.api,
        "registered": [_extent(span) for span in source.registered],
        "via": [_extent(span) for span in source.via],
    }


def _sink(sink: Sink) -> dict[str, Any]:
    return {
        "id": sink.id,
        **_extent(sink.span),
        "topics": list(sink.topics),
        **({"defaultTopics": list(sink.default_topics)} if sink.default_topics else {}),
        "type": sink.type,
        "api": sink.api,
    }


def _step(step: Step) -> dict[str, Any]:
    return {
        **_extent(step.span),
        "module": step.site.module,
        "qualname": step.site.qualname,
        "ordinal": step.site.ordinal,
        "code": step.code,
        "role": step.role,
        "dependence": step.dependence,
    }


def _extent(span: Span) -> dict[str, Any]:
    """Return a span: `at` is line, column, end line, end column."""
    return {"path": span.path, "at": [span.line, span.column, span.end_line, span.end_column]}
