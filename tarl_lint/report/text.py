"""The report for people, in full and concise (one finding a line)."""

from __future__ import annotations

from collections.abc import Iterator

from tarl_lint.model import Finding
from tarl_lint.report import summary
from tarl_lint.report.line import Line, Style, View, location, one_line
from tarl_lint.runner import UNREADABLE, Result


def report(result: Result, view: View) -> Iterator[Line]:
    """Yield unreadable files, flows by publish call, hazards, and the closing words."""
    yield from _errors(result)
    if result.errors and result.names_errors:
        yield ()
    yield from _flows(result, view)
    for finding in result.new:
        if finding.flow is None:
            yield from _hazard(finding, result, view)
    if flows := [f.flow for f in result.new if f.flow]:
        from tarl_lint.report.overview import overview

        yield from overview(flows, view)
    yield from summary.vanished(result, view)
    yield from summary.unused(result)
    if view.statistics:
        yield from summary.statistics(result)
    yield from summary.closing(result)
    yield from summary.hints(result, view)


def concise(result: Result, view: View) -> Iterator[Line]:
    """Yield each finding on a line of its own, then the closing words."""
    yield from _errors(result)
    for finding in result.new:
        yield _heading(finding)
    for line in (*summary.unused(result), *summary.vanished(result, view)):
        if line:
            yield line
    if view.statistics:
        yield from summary.statistics(result)
    yield from summary.closing(result)


def _errors(result: Result) -> Iterator[Line]:
    for error in result.errors if result.names_errors else ():
        yield (
            (f"{one_line(error.path)}:{error.line}:1", "place"),
            (f" {UNREADABLE} ", "error"),
            (error.message, ""),
        )


def _flows(result: Result, view: View) -> Iterator[Line]:
    """Yield every publish call; a flow that is the only one is shown with its taint list."""
    flows = [f for f in result.new if f.flow]
    if not flows:
        return
    from tarl_lint.report.flows import legend, publish_call, publish_calls  # clean files need not wait for it
    from tarl_lint.report.frame import lines_of

    paths = view.show_paths or len(flows) == 1
    for group in publish_calls(flows):
        source = lines_of(result.texts.get(group[0][1].sink.span.path, ""))
        yield from publish_call(group, source, view, paths=paths)
    if paths:
        yield legend(view)
        yield ()


def _hazard(finding: Finding, result: Result, view: View) -> Iterator[Line]:
    from tarl_lint.report.frame import frame, lines_of

    yield _heading(finding)
    yield from frame(lines_of(result.texts.get(finding.span.path, "")), finding.span, "hazard", view)
    yield ()


def _heading(finding: Finding) -> Line:
    style: Style = finding.flow.kind if finding.flow else "hazard"
    return ((location(finding.span), "place"), (f" {finding.code} ", style), (finding.message, ""))
