"""Files that are there whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path


def write_atomically(path: Path, content: bytes) -> None:
    """Write to a temporary file beside `path` and rename it, making folders as needed. Raises OSError.

    What is no file, as a device or a pipe, is written to and never replaced.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def replace_all(contents: Mapping[Path, bytes]) -> None:
    """Give existing files new contents, all of them or none; their modes stay, links are followed. Raises OSError."""
    targets = {path.resolve(): content for path, content in contents.items()}
    before = {path: path.read_bytes() for path in targets}
    staged: dict[Path, Path] = {}
    replaced: list[Path] = []
    try:
        for path, content in targets.items():
            staged[path] = _staged(path, content)
        for path, temporary in staged.items():
            replaced.append(path)
            temporary.replace(path)
    except BaseException:
        for path in replaced:
            _staged(path, before[path]).replace(path)
        raise
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)


def _staged(path: Path, content: bytes) -> Path:
    """Write a new content beside a file, with its mode."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        shutil.copymode(path, temporary)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return temporary
