"""Read patches: their header and their changes."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from pytest_tarl.errors import RepairError
from pytest_tarl.files import read_regular
from pytest_tarl.patching.changes import FilePatch, Hunk
from pytest_tarl.patching.patch import BASE, SEAL, TITLE, seal, split_lines, unquoted

_FACT = re.compile(r"# +([a-z][a-z -]*): (.*)")
_HUNK = re.compile(rb"@@ -(\d{1,9})(?:,(\d{1,9}))? \+(\d{1,9})(?:,(\d{1,9}))? @@.*\n")
_HEADER = (  # lines of a file after `diff --git`; git appends a tab to names with spaces
    re.compile(rb"a/(.+) b/(\1)\n"),
    re.compile(rb"index ([0-9a-f]{40})\.\.([0-9a-f]{40})\n"),
    re.compile(rb"--- a/([^\t\n]+)\t?\n"),
    re.compile(rb"\+\+\+ b/([^\t\n]+)\t?\n"),
)

# folders that no patch may change, because git and TARL run files from them
CLOSED = frozenset({".git", ".tarl"})


@dataclass(frozen=True)
class Patch:
    """A patch of TARL; `facts` are the keys and values of its header, in order."""

    path: Path
    title: str
    facts: tuple[tuple[str, str], ...]
    files: tuple[FilePatch, ...]

    @property
    def name(self) -> str:
        """Return the name used in messages."""
        return self.path.name

    @property
    def sealed(self) -> bool:
        """Return whether the patch contains its hash, which `read` has verified."""
        return bool(self.told(SEAL))

    @property
    def root(self) -> Path | None:
        """Return the folder that contains `.tarl`; None if the patch is elsewhere."""
        home = Path(os.path.normpath(self.path.absolute())).parent  # keep symbolic links: `.tarl` may be one
        inside = (home.name, home.parent.name) == ("patches", ".tarl")
        return home.parent.parent if inside else None

    @property
    def base(self) -> str:
        """Return the base folder of the patch's paths, relative to `root`."""
        return self.told(BASE)[-1]

    def told(self, key: str) -> list[str]:
        """Return all header values of a key; a merged patch may have several."""
        return [value for name, value in self.facts if name == key]


def read(path: Path) -> Patch:
    """Read a patch. Raise RepairError if it is not a complete patch of TARL."""
    try:
        content = unquoted(read_regular(path))
    except OSError as problem:
        raise RepairError(
            f"{path} cannot be read ({problem.strerror}): TARL writes patches to .tarl/patches."
        ) from problem
    head, *bodies = re.split(rb"^diff --git ", content, flags=re.MULTILINE)
    header = head.decode("utf-8", "replace").split("\n")
    facts = tuple((found[1], found[2]) for line in header if (found := _FACT.fullmatch(line)))
    if not bodies or not header[0].startswith(f"# {TITLE}") or BASE not in dict(facts):
        raise RepairError(
            f"{path} is not a patch of TARL, so TARL cannot check it: apply it with `git apply`."
        )
    damaged = RepairError(f"{path} is damaged: it was cut or edited. Run the repair again.")
    told = all(line.startswith("#") for line in header[:-1]) and dict(facts)[BASE].isprintable()
    if not told or not _whole(content, [value for key, value in facts if key == SEAL]):
        raise damaged
    try:
        files = tuple(_file(body) for body in bodies)
    except ValueError as problem:
        raise damaged from problem
    outside = next((file.name for file in files if not _inside(file.name)), None)
    if outside is not None:
        raise RepairError(f"{path} is not a patch of TARL: it changes {outside!r}, which no repair does.")
    if len({file.name for file in files}) < len(files):
        raise damaged
    return Patch(path, header[0].removeprefix("# "), facts, files)


def _whole(content: bytes, seals: Sequence[str]) -> bool:
    """Return whether the hash matches; True for a patch without a hash."""
    if not seals:
        return True
    line = f"# {SEAL}: {seals[0]}\n".encode("utf-8", "surrogateescape")
    return len(seals) == 1 and seal(content.replace(line, b"", 1)) == seals[0]


def _inside(name: str) -> bool:
    """Return whether a path stays below its base and outside `CLOSED`."""
    parts = name.split("/")
    odd = "\\" in name or not name.isprintable()
    return not odd and not {"", ".", ".."} & set(parts) and not in_closed_folder(parts)


def in_closed_folder(parts: Iterable[str]) -> bool:
    """Return whether a part of a path is a closed folder, in upper or lower case."""
    return not CLOSED.isdisjoint(map(str.lower, parts))


def _file(body: bytes) -> FilePatch:
    """Parse the section after `diff --git`. Raise ValueError."""
    lines = split_lines(body)
    first = next((at for at, line in enumerate(lines) if line.startswith(b"@@ ")), 0)
    if first != len(_HEADER):
        raise ValueError("no header")
    found = [pattern.fullmatch(line) for pattern, line in zip(_HEADER, lines[:first], strict=True)]
    names, index, old, new = (one.groups() if one else () for one in found)
    if not (names and index and old and new) or {*names, *old, *new} != {*old}:
        raise ValueError("names that differ")
    hunks = tuple(_hunks(lines[first:]))
    return FilePatch(old[0].decode("utf-8"), index[0].decode(), index[1].decode(), hunks)


def _hunks(lines: Sequence[bytes]) -> Iterator[Hunk]:
    """Yield the hunks. A line with a backslash means that the previous line has no line ending. Raise ValueError."""
    starts = [at for at, line in enumerate(lines) if line.startswith(b"@@ ")]
    for at, end in pairwise((*starts, len(lines))):
        found = _HUNK.fullmatch(lines[at])
        if found is None:
            raise ValueError("no hunk")
        start, old, new = int(found[1]), int(found[2] or 1), int(found[4] or 1)
        hunk = Hunk(start - (old > 0), tuple(_signed(lines[at + 1 : end])))
        if (len(hunk.old), len(hunk.new)) != (old, new) or hunk.start < 0:
            raise ValueError("a hunk has a wrong length")
        yield hunk


def _signed(lines: Sequence[bytes]) -> list[tuple[str, bytes]]:
    """Return the lines of a hunk with their signs. Raise ValueError."""
    body: list[tuple[str, bytes]] = []
    for line in lines:
        sign = line[:1].decode("ascii")
        if sign == "\\" and body and body[-1][1].endswith(b"\n"):
            body[-1] = (body[-1][0], body[-1][1].removesuffix(b"\n"))
        elif sign and sign in " +-" and line.endswith(b"\n"):
            body.append((sign, line[1:]))
        else:
            raise ValueError("a line belongs to no hunk")
    return body
