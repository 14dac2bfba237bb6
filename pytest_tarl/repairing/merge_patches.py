"""Merge the patches of several tests, or report the conflicting lines."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.errors import RepairError
from pytest_tarl.instrumentation.datafiles import is_data
from pytest_tarl.patching.merge import combined_diff, conflicts, constants
from pytest_tarl.patching.patch import apply_command, write
from pytest_tarl.patching.patch_reader import Patch, read


@dataclass(frozen=True)
class Joined:
    """Sentences about the patches that share files, and the commands that apply the patches."""

    lines: tuple[str, ...] = ()
    commands: tuple[str, ...] = ()


def joined(paths: Sequence[Path], cwd: Path) -> Joined:
    """Merge those patches of a run that share a file, where possible. Raise RepairError."""
    lines: list[str] = []
    commands: list[str] = []
    for group in _groups([read(path) for path in paths]):
        different = [
            one for at, one in enumerate(group) if one.files not in [each.files for each in group[:at]]
        ]
        for one in group:
            if one not in different:
                twin = next(each for each in different if each.files == one.files)
                lines.append(f"{one.name} makes the same change as {twin.name}: apply only one of them")
        told, kept = _as_one(different)
        lines += told
        commands += [apply_command(path, cwd) for path in kept]
    return Joined(tuple(lines), tuple(commands))


def _as_one(patches: Sequence[Patch]) -> tuple[list[str], list[Path]]:
    """Merge different patches of the same files; return sentences and the patches left to apply."""
    paths = [one.path for one in patches]
    if len(patches) < 2:
        return [], paths
    clashes = conflicts(patches)
    if clashes:
        what = "; ".join(dict.fromkeys(map(str, clashes)))
        return [f"{what}: apply one of them, then record and search for the other repair again"], paths
    try:
        combined = _combined(patches)
    except RepairError as problem:
        return [f"{' and '.join(one.name for one in patches)} cannot be merged: {problem}"], paths
    names = " and ".join(one.name for one in patches)
    shown = Path(os.path.relpath(combined, patches[0].root or combined.parent)).as_posix()
    return [
        f"{names} do not conflict: {shown} contains both changes; each was accepted on its own, so compare again"
    ], [combined]


def _combined(patches: Sequence[Patch]) -> Path:
    """Merge several patches and write the result. Raise RepairError if the files have changed since."""
    root = patches[0].root
    if root is None or len({one.base for one in patches}) > 1:
        raise RepairError("they belong to different repositories.")
    names = sorted({file.name for one in patches for file in one.files})
    originals = {name: (root / patches[0].base / name).read_bytes() for name in names}
    diff = combined_diff(patches, originals)
    path = write(diff, patches[0].path.parent, "combined", names[0])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for file in (one for one in read(path).files if not is_data(Path(one.name))):
                compile(file.applied(originals[file.name]), file.name, "exec", dont_inherit=True)
    except (SyntaxError, ValueError) as problem:
        path.unlink()
        raise RepairError(f"the merged file does not compile ({problem}).") from problem
    return path


def _groups(patches: Sequence[Patch]) -> Iterator[list[Patch]]:
    """Yield, in order, groups of patches that share files or constants, directly or through other patches."""
    left = list(patches)
    while left:
        group, files = [left.pop(0)], set[tuple[str, str]]()
        grew = True
        while grew:
            files |= {place for one in group for place in _touched(one)}
            more = [one for one in left if files & _touched(one)]
            left = [one for one in left if one not in more]
            group += more
            grew = bool(more)
        yield group


def _touched(patch: Patch) -> set[tuple[str, str]]:
    """Return the files and constants that a patch changes."""
    return {(patch.base, name) for name in (*(file.name for file in patch.files), *constants(patch))}
