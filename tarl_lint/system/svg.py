"""Picture of systems as SVG; no program for drawing graphs is needed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final
from xml.sax.saxutils import escape

from tarl_lint.files import shown
from tarl_lint.system.drawing import Drawing, EdgeKind, drawing, layers
from tarl_lint.system.model import System

CHARACTER: Final = 7.2  # mean width of a character at font size 12 (pixels)
ROW: Final = 44.0
BOX: Final = 26.0
GAP: Final = 56.0  # distance between columns (pixels)
MARGIN: Final = 16.0
_STYLE: Final = (
    "text{font:12px Helvetica,Arial,sans-serif;fill:#111;text-anchor:middle;dominant-baseline:central}"
    ".title{font-weight:bold;text-anchor:start}.topic{fill:#dbeafe;stroke:#3b82f6}.node{fill:#fff;stroke:#555}"
    ".unread{fill:#f8f8f8;stroke:#777;stroke-dasharray:5 3}path{fill:none;stroke:#555}"
    ".dashed{stroke-dasharray:5 3}.pure{stroke:#aaa}"
)
_CLASSES: Final[Mapping[EdgeKind, str]] = {
    "solid": "",
    "dashed": ' class="dashed"',
    "faint": ' class="dashed pure"',
    "touching": ' class="dashed"',
}


@dataclass(frozen=True)
class _Box:
    x: float
    y: float
    width: float


def report(systems: Sequence[System], origin: str = "", target: str = "") -> Iterator[str]:
    """Yield the lines of one picture, the systems one below the other."""
    body: list[str] = []
    width, top = 0.0, MARGIN
    for system in systems:
        body.append(f'<text class="title" x="{MARGIN}" y="{top + 8}">{escape(shown(system.file))}</text>')
        lines, right, bottom = _system(drawing(system, origin, target), top + 28)
        body += lines
        width, top = max(width, right), bottom + MARGIN
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width + MARGIN:.0f}" height="{top:.0f}" '
        f'viewBox="0 0 {width + MARGIN:.0f} {top:.0f}" role="img">'
    )
    yield "<title>Nodes and topics. Dashed boxes: not read. Dashed arrows: only in conditions, or not read.</title>"
    yield f"<style>{_STYLE}</style>"
    yield '<defs><marker id="arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
    yield 'orient="auto">'
    yield '<path d="M0,0 L8,4 L0,8 z" style="fill:#555;stroke:none"/></marker></defs>'
    yield from body
    yield "</svg>"


def _system(drawn: Drawing, top: float) -> tuple[list[str], float, float]:
    """Return the lines of a picture, and the coordinates of its right and lower edge."""
    columns = layers(drawn)
    tallest = max(map(len, columns), default=0)
    boxes: dict[str, _Box] = {}
    left = MARGIN
    for column in columns:
        width = max(len(name) - 2 for name in column) * CHARACTER + 24
        start = top + (tallest - len(column)) * ROW / 2
        for number, name in enumerate(column):
            own = (len(name) - 2) * CHARACTER + 24
            boxes[name] = _Box(left + (width - own) / 2, start + number * ROW, own)
        left += width + GAP
    lines = [_edge(boxes[one], boxes[other], kind) for one, other, kind in drawn.edges()]
    lines += [line for name, box in boxes.items() for line in _box(name, box, drawn)]
    return lines, left - GAP, top + tallest * ROW


def _edge(one: _Box, other: _Box, kind: EdgeKind) -> str:
    x1, y1 = one.x + one.width, one.y + BOX / 2
    x2, y2 = other.x, other.y + BOX / 2
    bend = GAP if x2 < x1 else max(GAP / 2, (x2 - x1) / 2)
    below = 2 * BOX if x2 < x1 else 0.0  # a backward edge passes below the boxes between its ends
    marker = "" if kind == "touching" else ' marker-end="url(#arrow)"'
    return (
        f'<path{_CLASSES[kind]} d="M{x1:.0f},{y1:.0f} C{x1 + bend:.0f},{y1 + below:.0f} '
        f'{x2 - bend:.0f},{y2 + below:.0f} {x2:.0f},{y2:.0f}"{marker}/>'
    )


def _box(name: str, box: _Box, drawn: Drawing) -> Iterator[str]:
    kind = drawn.kind(name)
    radius = BOX / 2 if kind == "topic" else 4
    yield (
        f'<rect class="{kind}" x="{box.x:.0f}" y="{box.y:.0f}" width="{box.width:.0f}" height="{BOX:.0f}" '
        f'rx="{radius:.0f}"/>'
    )
    yield f'<text x="{box.x + box.width / 2:.0f}" y="{box.y + BOX / 2:.0f}">{escape(name[2:])}</text>'
