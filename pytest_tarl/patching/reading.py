"""Patches as they are read back: header, files, hunks; and what they make of a file's bytes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.patch import BASE, TITLE, blob_id, split_lines

_FACT = re.compile(r"# +([a-z][a-z -]*): (.*)")
_HUNK = re.compile(rb"@@ -(\d+)(?:,(\d+))? \+(\d+)(?:,(\d+))? @@")
_INDEX = re.compile(rb"index ([0-9a-f]{40})\.\.([0-9a-f]{40})")
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


@dataclass(frozen=True)
class Patch:
    """A patch of TARL: `facts` are what its header tells, in order, `base` is what its paths are relative to."""

    path: Path
    title: str
    facts: tuple[tuple[str, str], ...]
    files: tuple[FilePatch, ...]

    @property
    def name(self) -> str:
        """Return the name that messages use."""
        return self.path.name

    @property
    def root(self) -> Path | None:
        """Return the folder that holds `.tarl`, None where the patch was carried elsewhere."""
        home = self.path.resolve().parent
        inside = (home.name, home.parent.name) == ("patches", ".tarl")
        return home.parent.parent if inside else None

    @property
    def base(self) -> str:
        """Return what the paths are relative to, as seen from the folder that holds `.tarl`."""
        return self.told(BASE)[-1]

    def told(self, key: str) -> list[str]:
        """Return all that the header says under a key; a combined patch says it for each of its parts."""
        return [value for name, value in self.facts if name == key]


def read(path: Path) -> Patch:
    """Read a patch. Raises RepairError where there is none, or where it is not one of TARL's."""
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise RepairError(
            f"{path} cannot be read ({problem.strerror}): patches of repairs are below .tarl/patches."
        ) from problem
    head, _, body = content.partition(b"diff --git ")
    header = head.decode("utf-8", "replace").split("\n")
    facts = tuple((found[1], found[2]) for line in header if (found := _FACT.fullmatch(line)))
    foreign = RepairError(
        f"{path} is not a patch of TARL, so there is nothing to check it by: apply it with `git apply`."
    )
    if not body or not header[0].startswith(f"# {TITLE}") or BASE not in dict(facts):
        raise foreign
    try:
        files = tuple(_file(part) for part in re.split(rb"^diff --git ", body, flags=re.MULTILINE))
    except (ValueError, AttributeError) as problem:
        raise RepairError(f"{path} is damaged: it was cut or edited. Make it again.") from problem
    if any(PurePosixPath(file.name).is_absolute() or ".." in file.name.split("/") for file in files):
        raise foreign
    return Patch(path, header[0].removeprefix("# "), facts, files)


def identical(content: bytes, name: str) -> bool:
    """Tell whether a content is the one that git calls `name`."""
    return blob_id(content) == name


def _file(text: bytes) -> FilePatch:
    lines = split_lines(text)
    index = _INDEX.search(text)
    names = [line for line in lines[:4] if line.startswith(b"--- a/")]
    if index is None or not names:
        raise ValueError("no header")
    name = names[0][len(b"--- a/") :].rstrip(b"\n").removesuffix(b"\t").decode("utf-8", "surrogateescape")
    first = next(at for at, line in enumerate(lines) if line.startswith(b"@@ "))
    hunks = tuple(_hunks(lines[first:]))
    return FilePatch(name, index[1].decode(), index[2].decode(), hunks)


def _hunks(lines: Sequence[bytes]) -> Iterator[Hunk]:
    """Yield the hunks; a line that is followed by a backslash has no ending. Raises ValueError."""
    at = 0
    while at < len(lines):
        found = _HUNK.match(lines[at])
        if found is None:
            raise ValueError("no hunk")
        start, old, new = int(found[1]), int(found[2] or 1), int(found[4] or 1)
        body: list[tuple[str, bytes]] = []
        at += 1
        while at < len(lines) and not lines[at].startswith(b"@@ "):
            sign, line = lines[at][:1].decode("ascii"), lines[at][1:]
            if sign == "\\":
                body[-1] = (body[-1][0], body[-1][1].removesuffix(b"\n"))
            elif sign in " +-":
                body.append((sign, line))
            at += 1
        hunk = Hunk(start - (old > 0), tuple(body))
        if (len(hunk.old), len(hunk.new)) != (old, new):
            raise ValueError("hunk of another length")
        yield hunk


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
