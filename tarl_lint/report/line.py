"""Lines of a report before colouring: pieces of text with their styles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from tarl_lint.model import Span

Style = Literal["", "place", "strong", "explicit", "implicit", "hazard", "error", "data", "control", "quiet"]
Line = tuple[tuple[str, Style], ...]

_TAB: Final = 4


@dataclass(frozen=True)
class Glyphs:
    """Signs that some terminals cannot show, with replacements."""

    bar: str = "│"
    data: str = "●"
    control: str = "◆"
    context: str = "·"
    arrow: str = "→"
    dots: str = "…"


ASCII: Final = Glyphs(bar="|", data="*", control="?", context=".", arrow="->", dots="...")


@dataclass(frozen=True)
class View:
    """Display settings of a report. `width` is in columns; 0 leaves long lines whole.

    `show_paths` shows the shortest chain of statements of each flow, `all_steps` all statements. At most `most_flows`
    flows are shown individually; 0 means all.
    """

    show_paths: bool = False
    all_steps: bool = False
    most_flows: int = 0
    statistics: bool = False
    width: int = 0
    glyphs: Glyphs = Glyphs()


def plain(line: Line) -> str:
    """Return the text of a line without its styles."""
    return "".join(text for text, _ in line)


def unbroken(line: Line) -> Line:
    """Return a line with line-ending characters escaped."""
    if not any("\n" in text or "\r" in text for text, _ in line):
        return line
    return tuple((text.replace("\n", "\\n").replace("\r", "\\r"), style) for text, style in line)


def location(span: Span) -> str:
    """Return the start of a span in the form that terminals and editors link."""
    return f"{one_line(span.path)}:{span.line}:{span.column}"


def one_line(path: str) -> str:
    """Return a path with line feeds escaped, which file names may contain."""
    return path.replace("\n", "\\n")


def columns(text: str) -> int:
    """Return the width of a string in terminal columns."""
    if text.isascii():
        return len(text)
    return sum(_columns(character) for character in text)


def _columns(character: str) -> int:
    import unicodedata  # imported only when needed, because most code is ASCII

    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def tabs(text: str) -> str:
    """Replace tabs by spaces, so that carets stay below their characters."""
    return text.expandtabs(_TAB)


def crop(text: str, width: int, dots: str) -> str:
    """Return a string shortened to a width in columns; a width of 0 or less leaves it whole."""
    if width <= 0 or columns(text) <= width:
        return text
    while text and columns(text) > width - len(dots):
        text = text[:-1]
    return text + dots
