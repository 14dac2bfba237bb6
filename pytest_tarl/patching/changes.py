"""What a patch does to files: hunks of lines, and what they make of a file's bytes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pytest_tarl.patching.patch import blob_id, split_lines

Lines = tuple[bytes, ...]


class MisfitError(Exception):
    """A hunk fits nowhere; the argument is the line (from 1) at which it was made."""


@dataclass(frozen=True, slots=True)
class Hunk:
    """Lines with their endings, by sign; `start` counts lines of the original before it."""

    start: int
    lines: tuple[tuple[str, bytes], ...]

    @property
    def old(self) -> Lines:
        """Return what it takes."""
        return tuple(line for sign, line in self.lines if sign != "+")

    @property
    def new(self) -> Lines:
        """Return what it puts there."""
        return tuple(line for sign, line in self.lines if sign != "-")


@dataclass(frozen=True, slots=True)
class Replacement:
    """The lines from `start` (from 0) on that are `old` become `new`; either may be empty."""

    start: int
    old: Lines
    new: Lines

    @property
    def end(self) -> int:
        """Return the first line behind it."""
        return self.start + len(self.old)


@dataclass(frozen=True, slots=True)
class FilePatch:
    """What a patch does to one file; `before` and `after` are git's names of its contents."""

    name: str
    before: str
    after: str
    hunks: tuple[Hunk, ...]

    @property
    def replacements(self) -> tuple[Replacement, ...]:
        """Return the lines that change, without those around them."""
        return tuple(one for hunk in self.hunks for one in _replacements(hunk))

    @property
    def reverse(self) -> FilePatch:
        """Return the patch that undoes it."""
        turned, shift = [], 0
        for hunk in self.hunks:
            lines = tuple(({"+": "-", "-": "+"}.get(sign, sign), line) for sign, line in hunk.lines)
            turned.append(Hunk(hunk.start + shift, lines))
            shift += len(hunk.new) - len(hunk.old)
        return FilePatch(self.name, self.after, self.before, tuple(turned))

    def exact(self, content: bytes) -> bytes | None:
        """Return what it makes of the very text that it was made for; None where git would call it otherwise."""
        if not identical(content, self.before):
            return None
        lines, result, at = split_lines(content), list[bytes](), 0
        for hunk in self.hunks:
            end = hunk.start + len(hunk.old)
            if hunk.start < at or tuple(lines[hunk.start : end]) != hunk.old:
                return None
            result += [*lines[at : hunk.start], *hunk.new]
            at = end
        made = b"".join((*result, *lines[at:]))
        return made if identical(made, self.after) else None

    def applied(self, content: bytes) -> bytes:
        """Return a file with the change in it, wherever its lines stand now. Raises MisfitError."""
        lines, result, at, shift = split_lines(content), list[bytes](), 0, 0
        for hunk in self.hunks:
            found = _place(hunk, lines, at, hunk.start + shift)
            if found is None:
                raise MisfitError(hunk.start + 1)
            result += [*lines[at:found], *hunk.new]
            at, shift = found + len(hunk.old), found - hunk.start
        return b"".join((*result, *lines[at:]))


def identical(content: bytes, name: str) -> bool:
    """Tell whether a content is the one that git calls `name`."""
    return blob_id(content) == name


def _replacements(hunk: Hunk) -> Iterator[Replacement]:
    at, old, new = hunk.start, list[bytes](), list[bytes]()
    for sign, line in (*hunk.lines, (" ", b"")):
        if sign == " " and (old or new):
            yield Replacement(at - len(old), tuple(old), tuple(new))
            old, new = [], []
        if sign == "+":
            new.append(line)
        else:
            old += [line] if sign == "-" else []
            at += 1


def _place(hunk: Hunk, lines: Sequence[bytes], least: int, likely: int) -> int | None:
    """Return the line nearest to `likely`, from `least` on, at which all lines of the original stand."""
    old = list(hunk.old)
    fits = [at for at in range(least, len(lines) - len(old) + 1) if lines[at : at + len(old)] == old]
    return min(fits, key=lambda at: abs(at - likely), default=None)
