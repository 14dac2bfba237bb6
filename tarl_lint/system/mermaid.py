"""Diagram of systems for Mermaid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report.mermaid import quoted
from tarl_lint.system.drawing import Drawing, drawing
from tarl_lint.system.model import System

_CLASSES: Final = (
    "  classDef topic fill:#dbeafe,stroke:#3b82f6,color:#111",
    "  classDef node fill:#fff,stroke:#777,color:#111",
    "  classDef unread fill:#f8f8f8,stroke:#777,color:#111,stroke-dasharray:4 3",
)


def report(systems: Sequence[System], origin: str = "", target: str = "") -> Iterator[str]:
    """Yield the graph of all systems, each in a box of its own if there are several."""
    yield "flowchart LR"
    yield "  %% solid: data is published; dotted: used only in conditions, or not at all; dashed box: not read"
    for number, system in enumerate(systems):
        several = len(systems) > 1
        if several:
            yield f"  subgraph s{number} [{quoted(shown(system.file))}]"
        yield from _graph(drawing(system, origin, target), f"s{number}" if several else "")
        if several:
            yield "  end"
    yield from _CLASSES


def _graph(drawn: Drawing, prefix: str) -> Iterator[str]:
    nodes = {name: f"{prefix}n{number}" for number, name in enumerate(drawn.nodes)}
    topics = {name: f"{prefix}t{number}" for number, name in enumerate(drawn.topics)}
    for name, short in topics.items():
        yield f"  {short}([{quoted(name)}]):::topic"
    for name, short in nodes.items():
        yield f"  {short}[{quoted(name)}]:::{'unread' if name in drawn.unread else 'node'}"
    for topic, node, kind in drawn.inputs:
        yield f"  {topics[topic]} {'-->' if kind == 'explicit' else '-.->'} {nodes[node]}"
    for node, topic in drawn.outputs:
        yield f"  {nodes[node]} {'-.->' if node in drawn.unread else '-->'} {topics[topic]}"
    for node, topic in drawn.touching:
        yield f"  {nodes[node]} -.- {topics[topic]}"
