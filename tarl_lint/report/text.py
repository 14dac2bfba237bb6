"""Text reports: full, and concise (one finding per line)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tarl_lint.model import Finding
from tarl_lint.report import closing_lines
from tarl_lint.report.line import Line, Style, View, location, one_line
from tarl_lint.run.runner import UNREADABLE, Result


def report(result: Result, view: View) -> Iterator[Line]:
    """Yield unreadable files, the map, the findings by package, and the closing lines."""
    yield from errors(result)
    if result.errors and result.names_errors:
        yield ()
    if flows := [f.flow for f in result.new if f.flow]:
        from tarl_lint.report.overview import overview  # imported late, since most reports have no flows

        yield from overview(flows, view)
    yield from _findings(result, view)
    yield from closing_lines.vanished(result, view)
    yield from closing_lines.unused(result)
    yield from closing_lines.unmatched(result)
    if view.statistics:
        yield from closing_lines.statistics(result)
    yield from closing_lines.closing(result)
    yield from closing_lines.hints(result, view)


def concise(result: Result, view: View) -> Iterator[Line]:
    """Yield one line per finding, then the closing lines."""
    yield from errors(result)
    for finding in result.new:
        yield heading(finding)
    for line in (
        *closing_lines.unused(result),
        *closing_lines.unmatched(result),
        *closing_lines.vanished(result, view),
    ):
        if line:
            yield line
    if view.statistics:
        yield from closing_lines.statistics(result)
    yield from closing_lines.closing(result)


def errors(result: Result) -> Iterator[Line]:
    """Yield a line for each unreadable file."""
    for error in result.errors if result.names_errors else ():
        yield (
            (f"{one_line(error.path)}:{error.line}:1", "place"),
            (f" {UNREADABLE} ", "error"),
            (error.message, ""),
        )


def _findings(result: Result, view: View) -> Iterator[Line]:
    """Yield the findings of each package. Of many flows, yield only the first ones, and the number of the others."""
    if not result.new:
        return
    from tarl_lint.report.by_package import grouped

    groups = grouped(result.new)
    room = view.most_flows or len(result.new)
    explained = not (view.show_paths or closing_lines.is_single(result))
    for group in groups:
        if len(groups) > 1:
            yield ((group.name, "strong"), (f": {group.counted}", ""))
            yield ()
        flows = [f for f in group.findings if f.flow]
        yield from _flows(flows[:room], result, view)
        if left := len(flows[room:]):
            yield ((f"    and {closing_lines.many(left, 'further flow')}", "quiet"),)
            yield ()
        room = max(0, room - len(flows))
        if flows and not explained:
            yield from _legend(view)
            explained = True
        for finding in group.findings:
            if finding.flow is None:
                yield from _hazard(finding, result, view)


def _legend(view: View) -> Iterator[Line]:
    from tarl_lint.report.flows import legend

    yield legend(view)
    yield ()


def _flows(flows: Sequence[Finding], result: Result, view: View) -> Iterator[Line]:
    """Yield every publish call; a single flow is shown with its chain of statements."""
    from tarl_lint.report.flows import publish_call, publish_calls
    from tarl_lint.report.frame import lines_of

    paths = view.show_paths or closing_lines.is_single(result)
    for group in publish_calls(flows):
        source = lines_of(result.texts.get(group[0][1].sink.span.path, ""))
        yield from publish_call(group, source, view, paths=paths)


def _hazard(finding: Finding, result: Result, view: View) -> Iterator[Line]:
    from tarl_lint.report.frame import frame, lines_of

    yield heading(finding)
    yield from frame(lines_of(result.texts.get(finding.span.path, "")), finding.span, "hazard", view)
    yield ()


def heading(finding: Finding) -> Line:
    """Return the place, rule and message of a finding."""
    style: Style = finding.flow.kind if finding.flow else "hazard"
    return ((location(finding.span), "place"), (f" {finding.code} ", style), (finding.message, ""))
