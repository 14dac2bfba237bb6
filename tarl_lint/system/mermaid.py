"""Diagram of systems for Mermaid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tarl_lint.files import shown
from tarl_lint.report.mermaid import quoted
from tarl_lint.system.drawing import Drawing, EdgeKind, drawing
from tarl_lint.system.model import System

_CLASSES: Final = (
    "  classDef topic fill:#dbeafe,stroke:#3b82f6,color:#111",
    "  classDef node fill:#fff,stroke:#777,color:#111",
    "  classDef unread fill:#f8f8f8,stroke:#777,color:#111,stroke-dasharray:4 3",
)
_ARROWS: Final[Mapping[EdgeKind, str]] = {
    "solid": "-->",
    "dashed": "-.->",
    "faint": "-.->",
    "touching": "-.-",
}


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
    names = drawn.short_names(prefix)
    for box, name in names.items():
        kind, label = drawn.kind(box), quoted(box[2:])
        yield f"  {name}{f'([{label}])' if kind == 'topic' else f'[{label}]'}:::{kind}"
    for start, end, edge in drawn.edges():
        yield f"  {names[start]} {_ARROWS[edge]} {names[end]}"
