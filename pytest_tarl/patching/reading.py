"""Patches as they are read back: what the header tells, and the changes of each file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path, PurePosixPath

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.changes import FilePatch, Hunk
from pytest_tarl.patching.patch import BASE, SEAL, TITLE, seal, split_lines, unquoted

_FACT = re.compile(r"# +([a-z][a-z -]*): (.*)")
_HUNK = re.compile(rb"@@ -(\d{1,9})(?:,(\d{1,9}))? \+(\d{1,9})(?:,(\d{1,9}))? @@.*\n")
_HEADER = (  # the lines of a file behind `diff --git`; git puts a tab behind names with spaces
    re.compile(rb"a/(.+) b/(\1)\n"),
    re.compile(rb"index ([0-9a-f]{40})\.\.([0-9a-f]{40})\n"),
    re.compile(rb"--- a/([^\t\n]+)\t?\n"),
    re.compile(rb"\+\+\+ b/([^\t\n]+)\t?\n"),
)


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
    def sealed(self) -> bool:
        """Tell whether it carries its digest, which was right when it was read."""
        return bool(self.told(SEAL))

    @property
    def root(self) -> Path | None:
        """Return the folder that holds `.tarl`, None where the patch was carried elsewhere."""
        home = Path(os.path.normpath(self.path.absolute())).parent  # as it is seen: `.tarl` may be a link
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
    """Read a patch. Raises RepairError where there is none, it is not one of TARL's, or it was cut or edited."""
    try:
        content = unquoted(path.read_bytes())
    except OSError as problem:
        raise RepairError(
            f"{path} cannot be read ({problem.strerror}): patches of repairs are below .tarl/patches."
        ) from problem
    head, *bodies = re.split(rb"^diff --git ", content, flags=re.MULTILINE)
    header = head.decode("utf-8", "replace").split("\n")
    facts = tuple((found[1], found[2]) for line in header if (found := _FACT.fullmatch(line)))
    if not bodies or not header[0].startswith(f"# {TITLE}") or BASE not in dict(facts):
        raise RepairError(
            f"{path} is not a patch of TARL, so TARL cannot check it: apply it with `git apply`."
        )
    damaged = RepairError(f"{path} is damaged: it was cut or edited. Make it again.")
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
    """Tell whether a patch is what was written, as far as it carries its digest."""
    if not seals:
        return True
    line = f"# {SEAL}: {seals[0]}\n".encode("utf-8", "surrogateescape")
    return len(seals) == 1 and seal(content.replace(line, b"", 1)) == seals[0]


def _inside(name: str) -> bool:
    """Tell whether a name stays below the folder that it is relative to, and out of what git keeps there."""
    parts = name.split("/")
    odd = PurePosixPath(name).is_absolute() or "\\" in name or not name.isprintable()
    return not odd and not {"", ".", ".."} & set(parts) and ".git" not in map(str.lower, parts)


def _file(body: bytes) -> FilePatch:
    """Read what stands behind `diff --git`. Raises ValueError."""
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
    """Yield the hunks; a line that is followed by a backslash has no ending. Raises ValueError."""
    starts = [at for at, line in enumerate(lines) if line.startswith(b"@@ ")]
    for at, end in pairwise((*starts, len(lines))):
        found = _HUNK.fullmatch(lines[at])
        if found is None:
            raise ValueError("no hunk")
        start, old, new = int(found[1]), int(found[2] or 1), int(found[4] or 1)
        hunk = Hunk(start - (old > 0), tuple(_signed(lines[at + 1 : end])))
        if (len(hunk.old), len(hunk.new)) != (old, new) or hunk.start < 0:
            raise ValueError("hunk of another length")
        yield hunk


def _signed(lines: Sequence[bytes]) -> list[tuple[str, bytes]]:
    """Return the lines of a hunk with their signs. Raises ValueError."""
    body: list[tuple[str, bytes]] = []
    for line in lines:
        sign = line[:1].decode("ascii")
        if sign == "\\" and body and body[-1][1].endswith(b"\n"):
            body[-1] = (body[-1][0], body[-1][1].removesuffix(b"\n"))
        elif sign and sign in " +-" and line.endswith(b"\n"):
            body.append((sign, line[1:]))
        else:
            raise ValueError("no line of a hunk")
    return body
