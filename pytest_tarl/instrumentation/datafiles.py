"""Replace the text that a test or node reads from data files: YAML parameters, launch and .cfg files."""

from __future__ import annotations

import builtins
import io
import os
import pathlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

Open = Callable[..., Any]
_SUFFIXES = (".yaml", ".yml", ".json", ".toml", ".xml", ".launch", ".cfg", ".launch.py", "_launch.py")


def is_data(path: Path) -> bool:
    """Return whether a file is a data file and not Python code."""
    return path.name.endswith(_SUFFIXES)


@contextmanager
def reading(overlay: Mapping[Path, str]) -> Iterator[None]:
    """Make reads of these files return their replacement texts; the files on disk stay unchanged."""
    if not overlay:
        yield
        return
    contents = {os.path.realpath(path): text.encode() for path, text in overlay.items()}
    stand_in = _opening(io.open, contents)
    with ExitStack() as patches:
        patches.enter_context(patch.object(builtins, "open", stand_in))
        patches.enter_context(patch.object(io, "open", stand_in))
        accessor = getattr(pathlib, "_NormalAccessor", None)  # in Python 3.10, pathlib stores io.open here
        if accessor is not None and hasattr(accessor, "open"):
            patches.enter_context(patch.object(accessor, "open", staticmethod(stand_in)))
        yield


def _opening(usual: Open, contents: Mapping[str, bytes]) -> Open:
    def stand_in(file: Any, mode: str = "r", *more: Any, **named: Any) -> Any:
        content = _content(file, contents) if set(mode) <= {"r", "b", "t"} else None
        if content is None:
            return usual(file, mode, *more, **named)
        raw = io.BytesIO(content)
        if "b" in mode:
            return raw
        given = dict(zip(("buffering", "encoding", "errors", "newline"), more, strict=False)) | named
        kept = {name: given[name] for name in ("encoding", "errors", "newline") if name in given}
        return io.TextIOWrapper(
            raw, **{"encoding": "utf-8", **{k: v for k, v in kept.items() if v is not None}}
        )

    return stand_in


def _content(file: Any, contents: Mapping[str, bytes]) -> bytes | None:
    if not isinstance(file, str | bytes | os.PathLike):
        return None
    return contents.get(os.path.realpath(os.fsdecode(file)))
