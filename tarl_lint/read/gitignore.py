"""Matching of .gitignore patterns, without git, so that results are the same on all machines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

DIRECTORIES: Final = None  # component that stands for any number of directories, including none
Component = re.Pattern[str] | None


@dataclass(frozen=True)
class Pattern:
    """One line of a .gitignore file, for paths relative to its directory."""

    components: tuple[Component, ...]
    negated: bool
    directories_only: bool

    def matches(self, path: str) -> bool:
        """Return whether the pattern matches a relative path. The time is at most proportional to path × pattern."""
        names = path.split("/")
        at = place = 0
        retry: tuple[int, int] | None = None  # backtrack: the last `**` takes one more directory
        while place < len(names):
            component = self.components[at] if at < len(self.components) else _NOTHING
            if component is DIRECTORIES:
                retry = (at, place + 1)
                at += 1
            elif component.fullmatch(names[place]):
                at, place = at + 1, place + 1
            elif retry is None:
                return False
            else:
                at, place = retry
                retry = (at, place + 1)
                at += 1
        return at == len(self.components)


@dataclass(frozen=True)
class Ignore:
    """The patterns of one .gitignore file, or of a setting, and their base directory."""

    directory: str
    patterns: tuple[Pattern, ...]

    def verdict(self, path: str, *, is_directory: bool) -> bool | None:
        """Return whether an absolute path is excluded; None if no pattern matches. The last matching pattern counts."""
        prefix = self.directory.rstrip("/") + "/"
        if not path.startswith(prefix):
            return None
        relative = path[len(prefix) :]
        for pattern in reversed(self.patterns):
            if (is_directory or not pattern.directories_only) and pattern.matches(relative):
                return not pattern.negated
        return None


def ignored(path: str, ignores: Sequence[Ignore], *, is_directory: bool) -> bool:
    """Return whether a path is excluded.

    The nearest .gitignore file with a match decides; in `ignores`, it comes last.
    """
    verdicts = (ignore.verdict(path, is_directory=is_directory) for ignore in reversed(ignores))
    return next((v for v in verdicts if v is not None), False)


def parse(directory: str, lines: Iterable[str]) -> Ignore:
    """Parse the lines of a .gitignore file in `directory` (absolute). Invalid patterns match nothing."""
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
    try:
        components = _components(text.removeprefix("/"))
    except re.error:
        return None
    if "/" not in text and components[0] is not DIRECTORIES:
        components = (DIRECTORIES, *components)
    return Pattern(components, negated, directories_only)


_MEMBER: Final = r"(?:\\.|[^]\\])"
_PIECES: Final = (
    r"(?P<dirs>(?:^|(?<=/))\*\*+/)|(?P<rest>/\*\*+$)|(?P<star>\*+)|(?P<one>\?)|\\(?P<escaped>.)"
    rf"|\[(?P<negated>[!^]?)(?P<set>(?:\]|(?<=[!^]){_MEMBER}|(?![!^]){_MEMBER}){_MEMBER}*)\]|(?P<plain>.)"
)
_NOTHING: Final = re.compile("(?!)")
_ANYTHING: Final = re.compile(".*", re.DOTALL)


def _components(text: str) -> tuple[Component, ...]:
    """Return the components of a pattern: one for each directory, and one for the name at the end.

    `*` and `?` match inside a component, `**` matches several components.
    """
    found: list[Component] = []
    pieces: list[str] = [""]  # pieces between the stars of the current component
    for match in re.finditer(_PIECES, text, re.DOTALL):
        kind = match.lastgroup
        if kind == "dirs":
            found.append(DIRECTORIES)
        elif kind == "rest":
            return (*found, _component(pieces), DIRECTORIES, _ANYTHING)
        elif (match["escaped"] or match["plain"]) == "/":
            found.append(_component(pieces))
            pieces = [""]
        elif kind == "star":
            pieces.append("")
        else:
            pieces[-1] += _piece(match)
    return (*found, _component(pieces))


def _component(pieces: Sequence[str]) -> re.Pattern[str]:
    """Return a regular expression for a name.

    Each piece matches at its first possible place, so no backtracking is needed.
    """
    first, *rest = pieces
    if not rest:
        return re.compile(first, re.DOTALL)
    middle = (f"(?=(?P<p{n}>.*?{piece}))(?P=p{n})" for n, piece in enumerate(rest[:-1]) if piece)
    return re.compile(f"{first}{''.join(middle)}.*{rest[-1]}", re.DOTALL)


def _piece(match: re.Match[str]) -> str:
    """Return the regular expression for a piece that matches one character."""
    text = match[0]
    if match["set"] is not None:
        return f"(?!/)[{'^' if match['negated'] else ''}{_members(match['set'])}]"
    if text in ("[", "\\"):
        return "(?!)"  # unclosed bracket or trailing backslash: git matches nothing
    return "." if text == "?" else re.escape(match["escaped"] or text)


def _members(text: str) -> str:
    """Return the contents of brackets in regular-expression syntax; `-` makes ranges in both."""
    pieces = re.findall(r"\\.|.", text, re.DOTALL)
    return "".join("-" if piece == "-" else re.escape(piece[-1]) for piece in pieces).replace("--", r"\-\-")
