"""JSON report: one document, frozen in `findings.schema.json`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final

from tarl_lint import __version__
from tarl_lint.model import Finding, Flow, Sink, Source, Span, Step
from tarl_lint.report.indented import Written, dumped
from tarl_lint.report.line import Line, View
from tarl_lint.run.runner import Result

FORMAT_VERSION: Final = 1  # 1: first format
STEP_LEVEL: Final = 5  # number of containers around a step: document, diagnostics, diagnostic, flow, steps

OfStep = Callable[[Step], object]


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the document, indented and in ASCII, so that terminals and pipes cannot alter it.

    Each finding is yielded as one piece, because the text of a large report is several times as large as its
    findings.
    """
    known: dict[Step, Written] = {}  # a cache, because flows share most of their steps

    def written(step: Step) -> Written:
        text = known.get(step)
        if text is None:
            text = known[step] = Written(dumped(statement(step), STEP_LEVEL))
        return text

    head = dumped({**_head(result), "diagnostics": []})
    if not result.findings:
        yield ((head, ""),)
        return
    yield ((head.removesuffix("]\n}"), ""),)
    for number, finding in enumerate(result.findings, 1):
        comma = "," if number < len(result.findings) else ""
        yield ((f"  {dumped(_diagnostic(finding, written), 2)}{comma}", ""),)
    yield ((" ]\n}", ""),)


def document(result: Result) -> dict[str, Any]:
    """Return all findings, including accepted flows, in the frozen order of keys."""
    return {**_head(result), "diagnostics": [_diagnostic(finding, statement) for finding in result.findings]}


def _head(result: Result) -> dict[str, Any]:
    return {
        "format": FORMAT_VERSION,
        "tool": {"name": "tarl-lint", "version": __version__},
        "files": result.statistics.files,
        "errors": [{"path": e.path, "line": e.line, "message": e.message} for e in result.errors],
        **incomplete(result),
    }


def incomplete(result: Result) -> dict[str, Any]:
    """Return the key `incomplete` with the programs that exhausted their budget; empty if there are none."""
    cut = result.statistics.cut
    each = [{"path": c.path, "node": c.node, "message": c.message} for c in cut]
    return {"incomplete": each} if each else {}


def _diagnostic(finding: Finding, of_step: OfStep) -> dict[str, Any]:
    flow = {"flow": _flow(finding.flow, of_step)} if finding.flow else {}
    return {
        "code": finding.code,
        **extent(finding.span),
        "message": finding.message,
        "fingerprint": finding.fingerprint,
        "status": finding.status,
        **flow,
    }


def _flow(flow: Flow, of_step: OfStep) -> dict[str, Any]:
    return {
        "kind": flow.kind,
        "source": _source(flow.source),
        "sink": _sink(flow.sink),
        "steps": [of_step(step) for step in flow.steps],
    }


def _source(source: Source) -> dict[str, Any]:
    return {
        "id": source.id,
        **_point(source.span),
        "topics": list(source.topics),
        **({"defaultTopics": list(source.default_topics)} if source.default_topics else {}),
        "type": source.type,
        "callback": source.callback,
        "api": source.api,
        "registered": _points(source.registered),
        "via": _points(source.via),
    }


def _sink(sink: Sink) -> dict[str, Any]:
    return {
        "id": sink.id,
        **_point(sink.span),
        "topics": list(sink.topics),
        **({"defaultTopics": list(sink.default_topics)} if sink.default_topics else {}),
        "type": sink.type,
        "api": sink.api,
    }


def statement(step: Step) -> dict[str, Any]:
    """Return a step of a taint list."""
    return {
        **extent(step.span),
        "qualname": step.site.qualname,
        "site": str(step.site),
        "code": step.code,
        "role": step.role,
        "dependence": step.dependence,
    }


def _points(spans: Sequence[Span]) -> list[dict[str, Any]]:
    return [_point(span) for span in spans]


def _point(span: Span) -> dict[str, Any]:
    return {"path": span.path, "line": span.line, "column": span.column}


def extent(span: Span) -> dict[str, Any]:
    """Return the file of a span, its start and its end."""
    return {**_point(span), "end_line": span.end_line, "end_column": span.end_column}
