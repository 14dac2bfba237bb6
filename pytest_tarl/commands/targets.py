"""The files that patches change: path, content, and the changes of each patch."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.errors import RepairError
from pytest_tarl.files import read_regular
from pytest_tarl.patching.changes import FilePatch, identical
from pytest_tarl.patching.patch_reader import Patch
from pytest_tarl.patching.patched_files import located


@dataclass(frozen=True)
class Target:
    """A file to change, with the changes of each patch."""

    path: Path
    project: Path
    shown: str
    content: bytes
    parts: tuple[tuple[Patch, FilePatch], ...]

    @property
    def as_searched(self) -> bool:
        """Return whether the file still has the text for which its patches were made."""
        return all(identical(self.content, file.before) for _, file in self.parts)

    @property
    def done(self) -> bool:
        """Return whether the file has one patch, and already contains its result."""
        return len(self.parts) == 1 and identical(self.content, self.parts[0][1].after)


def targets(patches: Sequence[Patch], directory: Path | None) -> list[Target]:
    """Find the files of all patches. Raise RepairError or RefusedError."""
    parts: dict[Path, list[tuple[Patch, FilePatch]]] = {}
    projects: dict[Path, Path] = {}
    for patch in patches:
        project, paths = located(patch, directory)
        for path, file in zip(paths, patch.files, strict=True):
            parts.setdefault(path, []).append((patch, file))
            projects[path] = project
    return [
        Target(path, projects[path], shown(path), _content(path), tuple(each))
        for path, each in sorted(parts.items())
    ]


def shown(path: Path) -> str:
    """Return a path relative to the working directory."""
    return Path(os.path.relpath(path.resolve(), Path.cwd())).as_posix()


def _content(path: Path) -> bytes:
    try:
        return read_regular(path)
    except OSError as problem:
        raise RepairError(f"{path} cannot be read ({problem.strerror}).") from problem
