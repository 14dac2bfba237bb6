"""Reuse reports in an editor session: a report remains valid if its analysis did not read the edited code.

Some edits only move lines: edits of comments, of blank lines, or of functions that a program does not use.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from tarl_lint.model import Finding, Flow, Sink, Source, Span, Step
from tarl_lint.prefilter.one_sided_groups import two_sided
from tarl_lint.read.moved_lines import moved_lines
from tarl_lint.read.source import Script
from tarl_lint.read.watched import Reading
from tarl_lint.run.cache import Report
from tarl_lint.settings.config import Config

KEPT_ANALYSES: Final = 4  # number of analyses kept per program
Moves = Mapping[str, Mapping[int, int]]  # file → line before the edit → line after the edit


class LineLostError(Exception):
    """It is not known where a line of a report is after an edit."""


@dataclass(frozen=True)
class _Analysis:
    scripts: tuple[Script, ...]
    readings: Mapping[str, Reading]
    report: Report


class Analyses:
    """The last analyses of each program in an editor session, by the path of its last file, newest first.

    Several analyses are kept because edits are often undone: the restored text is then the text of an earlier
    analysis.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        self._last: dict[str, tuple[_Analysis, ...]] = {}

    def keep(self, scripts: Sequence[Script], readings: Mapping[str, Reading], report: Report) -> None:
        """Keep a report, and the parts that its analysis has read of each file, unless a file could not be analysed."""
        if readings and not report.errors and two_sided([s.text for s in scripts], self._config):
            made, path = _Analysis(tuple(scripts), readings, report), scripts[-1].path
            self._last[path] = (made, *self._last.get(path, ()))[:KEPT_ANALYSES]

    def adapted(self, scripts: Sequence[Script]) -> Report | None:
        """Return the report that an analysis of the files would return; None if only an analysis can tell."""
        each = (self._moved(last, scripts) for last in self._last.get(scripts[-1].path, ()))
        return next((report for report in each if report is not None), None)

    def _moved(self, last: _Analysis, scripts: Sequence[Script]) -> Report | None:
        """Return the report of an analysis, with the lines of the edited texts; None if an edit may change it."""
        if [s.path for s in last.scripts] != [s.path for s in scripts]:
            return None
        moves: dict[str, Mapping[int, int]] = {}
        for before, now in zip(last.scripts, scripts, strict=True):
            if before == now:
                continue
            reading = last.readings.get(now.path)
            if reading is None or replace(before, text=now.text) != now:
                return None
            moved = moved_lines(before.text, now.text, reading)
            if moved is None:
                return None
            moves[now.path] = moved
        if not two_sided([s.text for s in scripts], self._config):
            return None
        try:
            return replace(last.report, findings=tuple(_finding(f, moves) for f in last.report.findings))
        except LineLostError:
            return None


def _finding(finding: Finding, moves: Moves) -> Finding:
    flow = None if finding.flow is None else _flow(finding.flow, moves)
    return replace(finding, span=_span(finding.span, moves), flow=flow)


def _flow(flow: Flow, moves: Moves) -> Flow:
    steps = tuple(_step(step, moves) for step in flow.steps)
    return replace(flow, source=_source(flow.source, moves), sink=_sink(flow.sink, moves), steps=steps)


def _step(step: Step, moves: Moves) -> Step:
    return replace(step, span=_span(step.span, moves))


def _source(source: Source, moves: Moves) -> Source:
    span = _span(source.span, moves)
    registered = tuple(_span(one, moves) for one in source.registered)
    via = tuple(_span(one, moves) for one in source.via)
    return replace(source, id=_named(source, span), span=span, registered=registered, via=via)


def _sink(sink: Sink, moves: Moves) -> Sink:
    span = _span(sink.span, moves)
    return replace(sink, id=_named(sink, span), span=span)


def _named(end: Source | Sink, span: Span) -> str:
    """Return the identity of a source or sink. If it has no known topic, the identity contains the line."""
    start = f"{end.module}:{end.qualname or '<module>'}:line "
    before = f"{start}{end.span.line}"
    if end.topics or span == end.span or not end.id.startswith(before):
        return end.id
    return f"{start}{span.line}{end.id.removeprefix(before)}"


def _span(span: Span, moves: Moves) -> Span:
    """Return a range of text after the edit. Raises LineLostError if a line of the report has no known place."""
    lines = moves.get(span.path)
    if lines is None:
        return span
    places = [lines.get(line) for line in range(span.line, span.end_line + 1)]
    first, last = places[0], places[-1]
    if first is None or last is None or last - first != span.end_line - span.line:
        raise LineLostError
    return replace(span, line=first, end_line=last)
