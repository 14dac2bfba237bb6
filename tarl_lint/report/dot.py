"""Diagram for Graphviz: `tarl-lint --format dot | dot -Tsvg -o flows.svg`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.report.line import Line, View
from tarl_lint.report.topics import Part, Picture, picture
from tarl_lint.run.runner import Result

_HEAD: Final = (
    "digraph flows {",
    " rankdir=LR; ranksep=0.9; nodesep=0.15; concentrate=false;",
    ' fontname="Helvetica"; fontsize=11; labeljust=l;',
    ' label="Solid: data is published. Dashed: used only in conditions. Each path through a box is a flow.";',
    ' node [fontname="Helvetica", fontsize=11, height=0.3, margin="0.12,0.05"];',
    ' edge [color="#555555", arrowsize=0.6];',
)
_COLOURS: Final = (
    "#1d4ed8",
    "#b45309",
    "#047857",
    "#be123c",
    "#6d28d9",
    "#0e7490",
    "#4d7c0f",
    "#a21caf",
    "#334155",
)
_TOPIC: Final = 'shape=ellipse, style=filled, fillcolor="#dbeafe", color="#3b82f6"'
_PART: Final = 'shape=box, style="rounded,filled", fillcolor=white, color="#777777"'
_NEW: Final = 'shape=box, style="rounded,filled", fillcolor="#fee2e2", color="#dc2626", penwidth=2'


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the graph; equal flows give equal text."""
    for text in _graph(picture(result)):
        yield ((text, ""),)


def _graph(drawn: Picture) -> Iterator[str]:
    yield from _HEAD
    numbers = drawn.numbers()
    for topic in drawn.topics:
        yield f" {numbers[topic.key]} [label={quoted(topic.label)}, {_TOPIC}];"
    edges: list[str] = []
    for index, (title, parts) in enumerate(drawn.boxes()):
        yield f" subgraph cluster{index} {{"
        yield f'  label={quoted(title)}; style="rounded,filled"; color="#dddddd"; fillcolor="#f8f8f8";'
        for name, part in parts:
            yield f"  {name} [label={quoted(part.label)}, {_NEW if part.new else _PART}];"
            edges.extend(_edges(part, name, numbers))
        yield " }"
    yield from edges
    yield "}"


def _edges(part: Part, name: str, numbers: dict[str, str]) -> Iterator[str]:
    for topic, kind in part.inputs:
        number = numbers[topic.key]
        colour = _COLOURS[int(number[1:]) % len(_COLOURS)]
        yield f' {number} -> {name} [color="{colour}"{", style=dashed" if kind == "implicit" else ""}];'
    for topic in part.outputs:
        yield f" {name} -> {numbers[topic.key]};"


def quoted(text: str) -> str:
    """Return a text as a string of Graphviz."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
