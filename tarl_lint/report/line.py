"""Lines of a report before anyone decides whether they are coloured: pieces of text with what they mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from tarl_lint.model import Span

Style = Literal["", "place", "strong", "explicit", "implicit", "hazard", "error", "data", "control", "quiet"]
Line = tuple[tuple[str, Style], ...]

_TAB: Final = 4


@dataclass(frozen=True)
class Glyphs:
    """Signs that not every terminal can show."""

    bar: str = "│"
    data: str = "●"
    control: str = "◆"
    context: str = "·"
    arrow: str = "→"
    dots: str = "…"


ASCII: Final = Glyphs(bar="|", data="*", control="?", context=".", arrow="->", dots="...")


@dataclass(frozen=True)
class View:
    """How a report is shown. `width` is in columns; 0 means that long lines stay whole.

    With `show_paths` each flow has its shortest chain of statements, with `all_steps` all of them. At most `most_flows`
    flows are shown one by one; 0 means all.
    """

    show_paths: bool = False
    all_steps: bool = False
    most_flows: int = 0
    statistics: bool = False
    width: int = 0
    glyphs: Glyphs = Glyphs()


def plain(line: Line) -> str:
    """Return a line without its meaning."""
    return "".join(text for text, _ in line)


def unbroken(line: Line) -> Line:
    """Return a line in which what would end it is written as an escape."""
    if not any("\n" in text or "\r" in text for text, _ in line):
        return line
    return tuple((text.replace("\n", "\\n").replace("\r", "\\r"), style) for text, style in line)


def location(span: Span) -> str:
    """Write where a span begins, so that terminals and editors can go there."""
    return f"{one_line(span.path)}:{span.line}:{span.column}"


def one_line(path: str) -> str:
    """Write a path without line feeds, which file names may have."""
    return path.replace("\n", "\\n")


def columns(text: str) -> int:
    """Return how many columns of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(_columns(character) for character in text)


def _columns(character: str) -> int:
    import unicodedata  # most code is ASCII

    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def tabs(text: str) -> str:
    """Replace tabs, so that what stands below a character stays below it."""
    return text.expandtabs(_TAB)


def crop(text: str, width: int, dots: str) -> str:
    """Shorten a text to a width in columns; a width of 0 or less leaves it whole."""
    if width <= 0 or columns(text) <= width:
        return text
    while text and columns(text) > width - len(dots):
        text = text[:-1]
    return text + dots
