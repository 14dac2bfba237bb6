"""Diagram of systems for Graphviz."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report.dot import quoted
from tarl_lint.system.drawing import Drawing, drawing
from tarl_lint.system.model import System

_HEAD: Final = (
    "digraph systems {",
    " rankdir=LR; ranksep=0.6; nodesep=0.15;",
    ' fontname="Helvetica"; fontsize=11; labeljust=l;',
    ' label="Solid: data is published. Dashed: used only in conditions, or not at all. Dashed box: not read.";',
    ' node [fontname="Helvetica", fontsize=11, height=0.3, margin="0.12,0.05"];',
    ' edge [color="#555555", arrowsize=0.6];',
)
_TOPIC: Final = 'shape=ellipse, style=filled, fillcolor="#dbeafe", color="#3b82f6"'
_NODE: Final = 'shape=box, style="rounded,filled", fillcolor=white, color="#777777"'
_UNREAD: Final = 'shape=box, style="rounded,filled,dashed", fillcolor="#f8f8f8", color="#777777"'


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
    nodes = {name: f"{prefix}n{number}" for number, name in enumerate(drawn.nodes)}
    topics = {name: f"{prefix}t{number}" for number, name in enumerate(drawn.topics)}
    for name, short in topics.items():
        yield f"  {short} [label={quoted(name)}, {_TOPIC}];"
    for name, short in nodes.items():
        yield f"  {short} [label={quoted(name)}, {_UNREAD if name in drawn.unread else _NODE}];"
    for topic, node, kind in drawn.inputs:
        yield f"  {topics[topic]} -> {nodes[node]}{'' if kind == 'explicit' else ' [style=dashed]'};"
    for node, topic in drawn.outputs:
        yield f"  {nodes[node]} -> {topics[topic]}{' [style=dashed]' if node in drawn.unread else ''};"
    for node, topic in drawn.touching:
        yield f"  {nodes[node]} -> {topics[topic]} [style=dashed, dir=none];"
