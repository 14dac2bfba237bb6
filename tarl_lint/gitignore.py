"""Patterns of .gitignore files and which paths they leave out: without git, so that all machines agree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Pattern:
    """One line of a .gitignore file, for paths relative to its directory."""

    regex: re.Pattern[str]
    negated: bool
    directories_only: bool


@dataclass(frozen=True)
class Ignore:
    """The patterns of one .gitignore file (or of a setting) and the directory that they are relative to."""

    directory: str
    patterns: tuple[Pattern, ...]

    def verdict(self, path: str, *, is_directory: bool) -> bool | None:
        """Tell whether an absolute path is left out; None when no pattern speaks of it. The last one wins."""
        prefix = self.directory.rstrip("/") + "/"
        if not path.startswith(prefix):
            return None
        relative = path[len(prefix) :]
        for pattern in reversed(self.patterns):
            if (is_directory or not pattern.directories_only) and pattern.regex.fullmatch(relative):
                return not pattern.negated
        return None


def ignored(path: str, ignores: Sequence[Ignore], *, is_directory: bool) -> bool:
    """Tell whether a path is left out: the nearest to speak of it decides (`ignores`: nearest last)."""
    verdicts = (ignore.verdict(path, is_directory=is_directory) for ignore in reversed(ignores))
    return next((v for v in verdicts if v is not None), False)


def parse(directory: str, lines: Iterable[str]) -> Ignore:
    """Read the lines of a .gitignore file in `directory` (absolute). Bad patterns match nothing."""
    patterns = (_pattern(line) for line in lines)
    return Ignore(directory, tuple(p for p in patterns if p is not None))


def _pattern(line: str) -> Pattern | None:
    text = re.sub(r"(?<!\\)\s+$", "", line)
    if not text or text.startswith("#"):
        return None
    negated = text.startswith("!")
    text = text[negated:]
    directories_only = text.endswith("/")
    text = text.removesuffix("/")
    if not text:
        return None
    anywhere = "/" not in text
    try:
        regex = re.compile(("(?:.*/)?" if anywhere else "") + _translate(text.removeprefix("/")), re.DOTALL)
    except re.error:
        return None
    return Pattern(regex, negated, directories_only)


_MEMBER: Final = r"(?:\\.|[^]\\])"
_PIECES: Final = (
    r"(?P<dirs>(?:^|(?<=/))\*\*+/)|(?P<rest>/\*\*+$)|(?P<star>\*+)|(?P<one>\?)|\\(?P<escaped>.)"
    rf"|\[(?P<negated>[!^]?)(?P<set>(?:\]|(?<=[!^]){_MEMBER}|(?![!^]){_MEMBER}){_MEMBER}*)\]|(?P<plain>.)"
)
_FIXED: Final = {"dirs": "(?:.*/)?", "rest": "/.*", "star": "[^/]*", "one": "[^/]"}


def _translate(text: str) -> str:
    """Write a pattern as a regular expression: `*` and `?` stay inside a path component, `**` does not."""
    return "".join(_piece(match) for match in re.finditer(_PIECES, text, re.DOTALL))


def _piece(match: re.Match[str]) -> str:
    kind, text = match.lastgroup or "", match[0]
    if kind == "set":
        return f"(?!/)[{'^' if match['negated'] else ''}{_members(match['set'])}]"
    if text in ("[", "\\"):
        return "(?!)"  # never closed, or nothing escaped: git matches nothing with it
    return _FIXED.get(kind) or re.escape(match["escaped"] or text)


def _members(text: str) -> str:
    """Write what stands between brackets as a regular expression has it there; `-` makes ranges in both."""
    pieces = re.findall(r"\\.|.", text, re.DOTALL)
    return "".join("-" if piece == "-" else re.escape(piece[-1]) for piece in pieces).replace("--", r"\-\-")
