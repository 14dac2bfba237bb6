"""Apply patches to files: hunks of lines, and their effect on a file's bytes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pytest_tarl.patching.patch import blob_id, split_lines

Lines = tuple[bytes, ...]


class MisfitError(Exception):
    """A hunk fits nowhere; the argument is its line number (from 1)."""


@dataclass(frozen=True, slots=True)
class Hunk:
    """Lines with line endings and signs ("+", "-" or " "). `start` is the line in the original, from 0."""

    start: int
    lines: tuple[tuple[str, bytes], ...]

    @property
    def old(self) -> Lines:
        """Return the lines that the hunk replaces."""
        return tuple(line for sign, line in self.lines if sign != "+")

    @property
    def new(self) -> Lines:
        """Return the lines that the hunk inserts."""
        return tuple(line for sign, line in self.lines if sign != "-")


@dataclass(frozen=True, slots=True)
class Replacement:
    """Replace the lines `old`, starting at line `start` (from 0), by `new`."""

    start: int
    old: Lines
    new: Lines

    @property
    def end(self) -> int:
        """Return the first line after the replaced ones."""
        return self.start + len(self.old)


@dataclass(frozen=True, slots=True)
class FilePatch:
    """A patch's changes to one file; `before` and `after` are git's blob ids of its contents."""

    name: str
    before: str
    after: str
    hunks: tuple[Hunk, ...]

    @property
    def replacements(self) -> tuple[Replacement, ...]:
        """Return the changed lines without context."""
        return tuple(one for hunk in self.hunks for one in _replacements(hunk))

    @property
    def reverse(self) -> FilePatch:
        """Return the patch that undoes this one."""
        turned, shift = [], 0
        for hunk in self.hunks:
            lines = tuple(({"+": "-", "-": "+"}.get(sign, sign), line) for sign, line in hunk.lines)
            turned.append(Hunk(hunk.start + shift, lines))
            shift += len(hunk.new) - len(hunk.old)
        return FilePatch(self.name, self.after, self.before, tuple(turned))

    def exact(self, content: bytes) -> bytes | None:
        """Return the patched content, or None if a blob id does not match."""
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
        """Return the patched content, even if lines have moved. Raise MisfitError."""
        lines, result, at, shift = split_lines(content), list[bytes](), 0, 0
        for hunk in self.hunks:
            found = _place(hunk, lines, at, hunk.start + shift)
            if found is None:
                raise MisfitError(hunk.start + 1)
            result += [*lines[at:found], *hunk.new]
            at, shift = found + len(hunk.old), found - hunk.start
        return b"".join((*result, *lines[at:]))


def identical(content: bytes, name: str) -> bool:
    """Return whether `name` is git's blob id of the content."""
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
    """Return the matching line nearest to `likely`, not before `least`, or None if the hunk matches nowhere."""
    old = list(hunk.old)
    fits = [at for at in range(least, len(lines) - len(old) + 1) if lines[at : at + len(old)] == old]
    return min(fits, key=lambda at: abs(at - likely), default=None)
