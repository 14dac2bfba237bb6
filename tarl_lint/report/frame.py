"""Code frames: the lines around a span, numbered, with carets below the span."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tarl_lint.model import Span
from tarl_lint.report.line import Line, Style, View, columns, crop, tabs

BEFORE = 2  # number of lines of context above a span
# maximum number of lines of a span that are shown; if a span is longer, only its first lines and its last line are
# shown
TALL = 6


def frame(source: Sequence[str], span: Span, style: Style, view: View) -> Iterator[Line]:
    """Yield the lines of a code frame. `source` is the lines of the file, without line ends."""
    if not 1 <= span.line <= len(source):
        return
    shown = _numbers(source, span)
    margin = len(str(shown[-1]))
    previous = shown[0] - 1
    for number in shown:
        if number != previous + 1:
            yield ((f"  {view.glyphs.dots:>{margin + 1}}", "quiet"),)
        previous = number
        yield from _numbered(source[number - 1], number, span, margin, style, view)


def lines_of(text: str) -> list[str]:
    """Split a string into lines as Python counts them; a form feed does not end a line."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _numbers(source: Sequence[str], span: Span) -> list[int]:
    """Return the line numbers to show: some lines before the span, without leading blank lines, then the span."""
    before = list(range(max(1, span.line - BEFORE), span.line))
    while before and not source[before[0] - 1].strip():
        before.pop(0)
    end = min(max(span.end_line, span.line), len(source))
    inside = list(range(span.line, end + 1))
    if len(inside) > TALL:
        inside = [*inside[: TALL - 2], end]
    return before + inside


def _numbered(text: str, number: int, span: Span, margin: int, style: Style, view: View) -> Iterator[Line]:
    gutter = f"  {{:>{margin + 1}}} {view.glyphs.bar} "
    room = view.width - len(gutter.format(number)) if view.width else 0
    marked = span.line <= number <= span.end_line
    body: Style = "" if marked else "quiet"
    yield ((gutter.format(number), "quiet"), (crop(tabs(text.rstrip()), room, view.glyphs.dots), body))
    if marked and text.strip():
        start, length = _underline(text, number, span)
        if room > 0:
            length = max(1, min(length, room - start))
        yield ((gutter.format(""), "quiet"), (" " * start + "^" * length, style))


def _underline(text: str, number: int, span: Span) -> tuple[int, int]:
    """Return the column and the number of the carets below a line, in terminal columns."""
    indent = len(text) - len(text.lstrip())
    first = span.column - 1 if number == span.line else indent
    last = span.end_column - 1 if number == span.end_line else len(text.rstrip())
    start = columns(tabs(text[:first]))
    return start, max(1, columns(tabs(text[:last])) - start)
