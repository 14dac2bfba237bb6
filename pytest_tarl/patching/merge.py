"""Merge patches of the same text, or report the lines on which they conflict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.changes import Replacement
from pytest_tarl.patching.patch import BASE, SEAL, bytes_diff, split_lines
from pytest_tarl.patching.patch_reader import Patch
from pytest_tarl.patching.same_lines import agreed


@dataclass(frozen=True, slots=True)
class Conflict:
    """Two patches that conflict on a line; `line` counts from 1."""

    file: str
    line: int
    first: Patch
    second: Patch

    def __str__(self) -> str:
        """Return a sentence with the line and the two patches."""
        return (
            f"{self.file}:{self.line} is changed in two ways, by {self.first.name} and by {self.second.name}"
        )


CONSTANT = "constant"  # header key that says where a changed constant is defined


def constants(patch: Patch) -> list[str]:
    """Return the constants that a patch changes, as `file:line name`."""
    return list(dict.fromkeys(patch.told(CONSTANT)))


def conflicts(patches: Sequence[Patch]) -> list[Conflict]:
    """Return the conflicts between patches of the same text."""
    found: list[Conflict] = []
    for at, first in enumerate(patches):
        for second in patches[at + 1 :]:
            theirs = {(file.name, file.before): file.replacements for file in second.files}
            for file in first.files:
                others = theirs.get((file.name, file.before), ())
                clashing = [
                    (mine, other) for mine in file.replacements for other in others if _clash(mine, other)
                ]
                lines = dict.fromkeys(max(mine.start, other.start) + 1 for mine, other in clashing)
                found += [Conflict(file.name, line, first, second) for line in lines]
            if not any({one.first, one.second} == {first, second} for one in found):
                found += _of_one_constant(first, second)
    return found


def combined(content: bytes, wanted: Sequence[Replacement]) -> bytes:
    """Return a text with all replacements made. Raise RepairError."""
    lines, result, at = split_lines(content), list[bytes](), 0
    for one in _in_order(wanted):
        if tuple(lines[one.start : one.end]) != one.old or one.start < at:
            raise RepairError(f"Line {one.start + 1} has changed, so the patches cannot be merged.")
        result += [*lines[at : one.start], *one.new]
        at = one.end
    return b"".join((*result, *lines[at:]))


def separated(content: bytes, wanted: Sequence[Replacement]) -> bytes | None:
    """Undo `combined`; return the original text, or None if a replacement is missing."""
    lines, result, at, shift = split_lines(content), list[bytes](), 0, 0
    for one in _in_order(wanted):
        start = one.start + shift
        end = start + len(one.new)
        if tuple(lines[start:end]) != one.new or start < at:
            return None
        result += [*lines[at:start], *one.old]
        at, shift = end, shift + len(one.new) - len(one.old)
    return b"".join((*result, *lines[at:]))


def combined_diff(patches: Sequence[Patch], originals: Mapping[str, bytes]) -> str:
    """Return one diff for several patches; `originals` maps file names to contents before the patches."""
    texts = {}
    for name, original in originals.items():
        files = [file for patch in patches for file in patch.files if file.name == name]
        texts[name] = (original, combined(original, [one for file in files for one in file.replacements]))
    header = [
        f"{patches[0].title.partition(':')[0]}: {len(patches)} repairs, each accepted on its own, merged"
    ]
    for patch in patches:
        header.append(f"part {patch.name}")
        header += [f"  {key}: {value}" for key, value in patch.facts if key not in (BASE, SEAL)]
    return bytes_diff(texts, patches[0].base, header)


def same_change(first: Patch, second: Patch) -> bool:
    """Return whether two patches make the same changes."""
    return first.files == second.files


def _of_one_constant(first: Patch, second: Patch) -> Iterator[Conflict]:
    """Yield conflicts on constants that both patches change."""
    for told in constants(first):
        file, _, line = told.partition(" ")[0].rpartition(":")
        if told in constants(second) and line.isdecimal() and first.base == second.base:
            yield Conflict(file, int(line), first, second)


def _in_order(wanted: Sequence[Replacement]) -> list[Replacement]:
    """Return the distinct replacements in order, merged where possible."""
    ordered: list[Replacement] = []
    for one in sorted(dict.fromkeys(wanted), key=lambda one: (one.start, one.end)):
        joined = agreed(ordered[-1], one) if ordered else None
        if joined is None:
            ordered.append(one)
        else:
            ordered[-1] = joined
    return ordered


def _clash(one: Replacement, other: Replacement) -> bool:
    """Return whether two replacements overlap; pure insertions never do."""
    if one == other or agreed(one, other) is not None:
        return False
    return one.start < other.end and other.start < one.end
