"""Diagram of systems for Graphviz."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report.dot import quoted
from tarl_lint.system.drawing import BoxKind, Drawing, EdgeKind, drawing
from tarl_lint.system.model import System

_HEAD: Final = (
    "digraph systems {",
    " rankdir=LR; ranksep=0.6; nodesep=0.15;",
    ' fontname="Helvetica"; fontsize=11; labeljust=l;',
    ' label="Solid: data is published. Dashed: used only in conditions, or not at all. Dashed box: not read.";',
    ' node [fontname="Helvetica", fontsize=11, height=0.3, margin="0.12,0.05"];',
    ' edge [color="#555555", arrowsize=0.6];',
)
_BOXES: Final[Mapping[BoxKind, str]] = {
    "topic": 'shape=ellipse, style=filled, fillcolor="#dbeafe", color="#3b82f6"',
    "node": 'shape=box, style="rounded,filled", fillcolor=white, color="#777777"',
    "unread": 'shape=box, style="rounded,filled,dashed", fillcolor="#f8f8f8", color="#777777"',
}
_EDGES: Final[Mapping[EdgeKind, str]] = {
    "solid": "",
    "dashed": " [style=dashed]",
    "faint": " [style=dashed]",
    "touching": " [style=dashed, dir=none]",
}


def report(systems: Sequence[System], origin: str = "", target: str = "") -> Iterator[str]:
    """Yield the graph of all systems, each in a box of its own if there are several."""
    yield from _HEAD
    for number, system in enumerate(systems):
        several = len(systems) > 1
        if several:
            yield f" subgraph cluster{number} {{"
            yield f'  label={quoted(shown(system.file))}; style="rounded"; color="#dddddd";'
        yield from _graph(drawing(system, origin, target), f"s{number}")
        if several:
            yield " }"
    yield "}"


def _graph(drawn: Drawing, prefix: str) -> Iterator[str]:
    names = drawn.short_names(prefix)
    for box, name in names.items():
        yield f"  {name} [label={quoted(box[2:])}, {_BOXES[drawn.kind(box)]}];"
    for start, end, kind in drawn.edges():
        yield f"  {names[start]} -> {names[end]}{_EDGES[kind]};"
