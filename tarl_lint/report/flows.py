"""Flows in the text report: a code frame for each publish call, its sources, and their taint lists."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Final

from tarl_lint.model import Dependence, Finding, Flow, Sink, Source, Step
from tarl_lint.report.frame import frame
from tarl_lint.report.line import Glyphs, Line, Style, View, columns, crop, location, one_line, tabs

_LONG: Final = 12  # maximum number of steps in a list that is shown in full
_WIDE: Final = 140  # width of a statement in columns if there is no terminal
_STYLES: Final[Mapping[Dependence, Style]] = {"data": "data", "control": "control", "context": "quiet"}


def publish_calls(findings: Sequence[Finding]) -> Iterator[tuple[tuple[Finding, Flow], ...]]:
    """Yield the flows that end in the same publish call, in the order of `findings`."""
    pairs = ((finding, finding.flow) for finding in findings if finding.flow)
    for _, group in groupby(pairs, key=lambda pair: (pair[1].sink.span, pair[1].sink.id)):
        yield tuple(group)


def publish_call(
    group: Sequence[tuple[Finding, Flow]], source: Sequence[str], view: View, *, paths: bool
) -> Iterator[Line]:
    """Yield one publish call: heading, code frame, then each flow that ends in it, with its taint list."""
    sink = group[0][1].sink
    explicit = any(flow.kind == "explicit" for _, flow in group)
    yield _heading(sink)
    yield from frame(source, sink.span, "explicit" if explicit else "implicit", view)
    names = _aligned([describe(shown(flow.source), flow.source.type) for _, flow in group])
    yield ()
    for name, (finding, flow) in zip(names, group, strict=True):
        yield _flow(finding, flow, name)
        if paths:
            yield from taint_list(flow, view)
            yield ()
    if not paths:
        yield ()


def describe(topics: Sequence[str], message: str) -> str:
    """Return topics with their message type: `odom (Odometry)`."""
    topic = " or ".join(topics) or "unknown topic"
    return f"{topic} ({message})" if message else topic


def shown(end: Source | Sink) -> list[str]:
    """Return the topics of an end of a flow; those that may be replaced are marked as defaults."""
    return [f"{topic} (default)" if topic in end.default_topics else topic for topic in end.topics]


def _heading(sink: Sink) -> Line:
    place = f" in {sink.qualname}" if sink.qualname else ""
    name = describe(shown(sink), sink.type)
    return ((location(sink.span), "place"), (" publishes ", ""), (name, "strong"), (place, ""))


def _aligned(texts: Sequence[str]) -> list[str]:
    if not texts:
        return []
    widest = max(map(columns, texts))
    return [text + " " * (widest - columns(text)) for text in texts]


def _flow(finding: Finding, flow: Flow, name: str) -> Line:
    return (
        ("    ", ""),
        (f"{finding.code} {flow.kind}", flow.kind),
        (" from ", ""),
        (name, "strong"),
        (f"  {subscription(flow)}", "quiet"),
    )


def subscription(flow: Flow) -> str:
    """Return the place of the subscription relative to the publish call: `line 36, on_odom`."""
    source, sink = flow.source, flow.sink
    place = f"line {source.span.line}"
    if source.span.path != sink.span.path:
        place = f"{one_line(source.span.path)}:{source.span.line}"
    owner = sink.qualname.rpartition(".")[0]
    callback = source.callback.removeprefix(f"{owner}.") if owner else source.callback
    return f"{place}, {callback}" if callback else place


def taint_list(flow: Flow, view: View) -> Iterator[Line]:
    """Yield the steps of a flow: line, role, dependence on the source, code.

    A long list is reduced to its shortest chain, except if all steps are requested.
    """
    steps = shown_steps(flow, view)
    beside = flow.sink.span.path
    places = [_where(step, beside) for step in steps]
    margin = max(map(columns, places), default=0)
    roles = max((len(step.role) for step in steps), default=0)
    for place, step in zip(places, steps, strict=True):
        start = f"      {' ' * (margin - columns(place))}{place}  {step.role:<{roles}}  "
        style = _STYLES[step.dependence]
        room = (view.width or _WIDE) - columns(start) - 2
        text: Style = "quiet" if step.dependence == "context" else ""
        code = crop(_one_line(step.code), room, view.glyphs.dots)
        yield ((start, "quiet"), (_mark(step.dependence, view.glyphs), style), (" ", ""), (code, text))
    if left := len(flow.steps) - len(steps):
        words = f"{view.glyphs.dots} shortest path; {left} more statements (--all-steps)"
        yield ((f"      {words}", "quiet"),)


def shown_steps(flow: Flow, view: View) -> Sequence[Step]:
    """Return the steps to show: for a long list, the registration and the shortest chain; otherwise all steps."""
    if view.all_steps or len(flow.steps) <= _LONG or not flow.chain:
        return flow.steps
    registration = [step for step in flow.steps if step.role == "register"]
    return (*registration, *(flow.steps[place] for place in flow.chain))


def _where(step: Step, beside: str) -> str:
    return str(step.span.line) if step.span.path == beside else f"{one_line(step.span.path)}:{step.span.line}"


def _one_line(code: str) -> str:
    """Join the lines of a statement, without spaces next to brackets at line ends."""
    joined = ""
    for line in (line.strip() for line in tabs(code).splitlines()):
        tight = joined.endswith(("(", "[", "{")) or line.startswith((")", "]", "}"))
        joined = joined.removesuffix(",") + line if line[:1] in ")]}" else joined + " " * (not tight) + line
    return joined.strip()


def _mark(dependence: Dependence, glyphs: Glyphs) -> str:
    return {"data": glyphs.data, "control": glyphs.control, "context": glyphs.context}[dependence]


def legend(view: View) -> Line:
    """Explain the marks of taint lists."""
    glyphs = view.glyphs
    return (
        ("      ", ""),
        (glyphs.data, "data"),
        (" passes on the value   ", "quiet"),
        (glyphs.control, "control"),
        (" condition   ", "quiet"),
        (f"{glyphs.context} context", "quiet"),
    )
