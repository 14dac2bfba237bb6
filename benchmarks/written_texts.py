"""Workspaces of benchmarks, each in one text; each of its files follows a line `--- path`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

_FILE: Final = re.compile(r"^--- (\S+)\n", re.MULTILINE)


@dataclass(frozen=True)
class Texts:
    """The files of a workspace by name."""

    files: Mapping[str, str]

    @classmethod
    def read(cls, path: Path) -> Texts:
        """Return the files of the workspace in a text."""
        parts = _FILE.split(path.read_text("utf-8"))
        return cls(dict(zip(parts[1::2], parts[2::2], strict=True)))

    def unpack(self, root: Path) -> None:
        """Write the files to a folder."""
        for name, text in self.files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, "utf-8")

    def line(self, place: str) -> str:
        """Return the line `path:number`."""
        path, _, number = place.rpartition(":")
        return self.files[path].splitlines()[int(number) - 1]
