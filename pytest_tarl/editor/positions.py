"""Convert positions: the linter counts characters from 1, the protocol counts UTF-16 code units from 0."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from lsprotocol import types

from tarl_lint.model import Span


def units(text: str) -> int:
    """Return the length of a string in UTF-16 code units."""
    return len(text) + sum(ord(character) > 0xFFFF for character in text)


class Places:
    """Convert spans to ranges and locations. `texts` maps the paths in spans to file contents."""

    def __init__(self, root: Path, texts: Mapping[str, str]) -> None:
        self._root = root
        self._texts = texts
        self._lines: dict[str, list[str]] = {}

    def uri(self, path: str) -> str:
        """Return the URI of a file."""
        return (self._root / path).as_uri()

    def line(self, path: str, number: int) -> str:
        """Return line `number` (from 1) without its line ending; empty if it does not exist or was not linted."""
        if path not in self._lines:
            self._lines[path] = self._texts.get(path, "").split("\n")
        lines = self._lines[path]
        return lines[number - 1].rstrip("\r") if 0 < number <= len(lines) else ""

    def position(self, path: str, line: int, column: int) -> types.Position:
        """Return the position before a character."""
        return types.Position(line - 1, units(self.line(path, line)[: column - 1]))

    def range(self, span: Span) -> types.Range:
        """Return the range of a span."""
        return types.Range(
            self.position(span.path, span.line, span.column),
            self.position(span.path, span.end_line, span.end_column),
        )

    def location(self, span: Span) -> types.Location:
        """Return the location of a span."""
        return types.Location(self.uri(span.path), self.range(span))

    def end_of_line(self, path: str, line: int) -> types.Position:
        """Return the position after the last character of a line."""
        return types.Position(line - 1, units(self.line(path, line)))
