"""Diagram for Mermaid, which GitHub and GitLab render in comments, summaries and Markdown files."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.report.line import Line, View
from tarl_lint.report.topics import Part, Picture, picture
from tarl_lint.run.runner import Result

_CLASSES: Final = (
    "  classDef topic fill:#dbeafe,stroke:#3b82f6,color:#111",
    "  classDef part fill:#fff,stroke:#777,color:#111",
    "  classDef new fill:#fee2e2,stroke:#dc2626,color:#111,stroke-width:2px",
)


def report(result: Result, _view: View) -> Iterator[Line]:
    """Yield the graph; equal flows give equal text."""
    for text in _graph(picture(result)):
        yield ((text, ""),)


def _graph(drawn: Picture) -> Iterator[str]:
    yield "flowchart LR"
    yield "  %% solid: data is published; dotted: used only in conditions; each path through a box is a flow"
    numbers = drawn.numbers()
    for topic in drawn.topics:
        yield f"  {numbers[topic.key]}([{quoted(topic.label)}]):::topic"
    edges: list[str] = []
    for index, (title, parts) in enumerate(drawn.boxes()):
        yield f"  subgraph s{index} [{quoted(title)}]"
        for name, part in parts:
            yield f"    {name}[{quoted(part.label)}]:::{'new' if part.new else 'part'}"
            edges.extend(_edges(part, name, numbers))
        yield "  end"
    yield from edges
    yield from _CLASSES


def _edges(part: Part, name: str, numbers: dict[str, str]) -> Iterator[str]:
    for topic, kind in part.inputs:
        yield f"  {numbers[topic.key]} {'-.->' if kind == 'implicit' else '-->'} {name}"
    for topic in part.outputs:
        yield f"  {name} --> {numbers[topic.key]}"


def quoted(text: str) -> str:
    """Return a string quoted, so that Mermaid reads none of its characters as syntax or markup."""
    escaped = text.replace("#", "#35;").replace('"', "#quot;").replace("<", "#lt;").replace(">", "#gt;")
    return '"' + escaped.replace("`", "#96;").replace("\n", "<br/>") + '"'
