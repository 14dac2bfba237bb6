"""Flows across nodes as lines of a report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.model import Step
from tarl_lint.report.line import Glyphs, Line, Style, View, location
from tarl_lint.system.model import Chain, Hop

_KINDS: Final[Mapping[str, Style]] = {"explicit": "explicit", "implicit": "implicit", "not read": "quiet"}


def in_line(chain: Chain, glyphs: Glyphs) -> Line:
    """Return the topics and nodes of a flow, with its kind."""
    arrow = f" {glyphs.arrow} "
    pieces: list[tuple[str, Style]] = [(chain.hops[0].source, "place")]
    for hop in chain.hops:
        node: tuple[str, Style] = (hop.node, "")
        if hop.kind == "not read":
            node = (f"[{hop.node}, not read]", "quiet")
        pieces += [(arrow, ""), node, (arrow, ""), (hop.sink, "place")]
    return (*pieces, (f"  {chain.kind}", _KINDS[chain.kind]))


def statements(chain: Chain, view: View) -> Iterator[Line]:
    """Yield the statements of each node on the way: those of the shortest chain, or all if the view asks for all."""
    for hop in chain.hops:
        yield from _steps(hop, view)


def _steps(hop: Hop, view: View) -> Iterator[Line]:
    """Yield the taint list of a hop: its shortest chain of statements, or all of them."""
    if not hop.findings or hop.findings[0].flow is None:
        return
    flow = hop.findings[0].flow
    named = f"    {hop.node}: {hop.source} {view.glyphs.arrow} {hop.sink}"
    yield (named, "quiet"), (f"  {hop.kind}", _KINDS[hop.kind])
    steps = flow.steps if view.all_steps or not flow.chain else [flow.steps[index] for index in flow.chain]
    for step in steps:
        yield _step(step, view.glyphs)


def _step(step: Step, glyphs: Glyphs) -> Line:
    sign = {"data": glyphs.data, "control": glyphs.control, "context": glyphs.context}[step.dependence]
    code = " ".join(step.code.split())
    return ((f"      {sign} ", step.dependence if step.dependence != "context" else "quiet"),
            (f"{location(step.span)}", "place"), (f"  {code}", ""))  # fmt: skip
