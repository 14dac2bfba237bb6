"""Annotations in pull requests: workflow commands of GitHub Actions, one for each publish call."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.model import Finding, Flow, Span
from tarl_lint.report import closing_lines
from tarl_lint.report.flows import describe, publish_calls, subscription
from tarl_lint.report.grading import Level, level
from tarl_lint.report.line import Line, View
from tarl_lint.run.runner import UNREADABLE, Result

_COMMANDS: Final[Mapping[Level, str]] = {"note": "notice", "warning": "warning", "error": "error"}
_GRAVEST: Final[Sequence[Level]] = ("note", "warning", "error")


def report(result: Result, view: View) -> Iterator[Line]:
    """Yield annotations and the closing lines.

    The most severe come first, since GitHub shows only ten of each kind.
    """
    noted = [*_errors(result), *_flows(result), *_hazards(result), *_unused(result), *_incomplete(result)]
    for grade in reversed(_GRAVEST):
        for own, span, title, text in noted:
            if own == grade:
                yield ((_command(own, span, title, text), ""),)
    yield from closing_lines.vanished(result, view)
    yield from closing_lines.unmatched(result)
    yield from closing_lines.closing(result)


_Note = tuple[Level, Span, str, str]


def _errors(result: Result) -> Iterator[_Note]:
    for error in result.errors if result.names_errors else ():
        yield "warning", Span(error.path, error.line, 1, error.line, 1), UNREADABLE, error.message


def _flows(result: Result) -> Iterator[_Note]:
    for group in publish_calls([f for f in result.new if f.flow]):
        sink = group[0][1].sink
        grade = max((level(f.code, result) for f, _ in group), key=_GRAVEST.index)
        codes = ", ".join(sorted({f.code for f, _ in group}))
        text = "\n".join(_sentence(finding, flow) for finding, flow in group)
        yield grade, sink.span, f"{codes}: {describe(sink.topics, sink.type)}", text


def _sentence(finding: Finding, flow: Flow) -> str:
    return f"{finding.message}: {flow.kind}, subscribed at {subscription(flow)}."


def _hazards(result: Result) -> Iterator[_Note]:
    for finding in result.new:
        if finding.flow is None:
            yield level(finding.code, result), finding.span, finding.code, finding.message


def _unused(result: Result) -> Iterator[_Note]:
    for comment in result.unused:
        span = Span(comment.path, comment.line, comment.column, comment.line, comment.column)
        text = closing_lines.in_vain(comment)
        yield "note", span, "tarl-lint", text[:1].upper() + text[1:]


def _incomplete(result: Result) -> Iterator[_Note]:
    for cut in result.statistics.cut:
        yield "note", Span(cut.path, 1, 1, 1, 1), "tarl-lint: incomplete", cut.message


def _command(grade: Level, span: Span, title: str, text: str) -> str:
    where = {
        "file": span.path,
        "line": span.line,
        "endLine": span.end_line,
        "col": span.column,
        "endColumn": span.end_column,
        "title": title,
    }
    if span.end_line != span.line:  # GitHub takes columns only within one line
        del where["col"], where["endColumn"]
    properties = ",".join(f"{key}={_property(str(value))}" for key, value in where.items())
    return f"::{_COMMANDS[grade]} {properties}::{_data(text)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
