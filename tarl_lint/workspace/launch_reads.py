"""Models of functions that read workspace files in launch files."""

from __future__ import annotations

import copy
import csv
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.launch_folders import listings
from tarl_lint.workspace.launch_ini import IniFile
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.parameter_yaml import NoYamlError, content
from tarl_lint.workspace.python.elements import bounded
from tarl_lint.workspace.python.paths import FilePath, normal
from tarl_lint.workspace.python.values import OpaqueError, Stream, Unknown

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)


@dataclass(frozen=True)
class OpenFile:
    """The result of `open` for a file of the workspace."""

    path: Path
    readable: ClassVar = frozenset({"read", "readlines", "close", "name"})

    def read(self, *_: Any) -> Any:
        """Return the text; Unknown if the file cannot be read. Raises FileNotFoundError."""
        if not self.path.exists():
            raise FileNotFoundError(2, "No such file or directory", str(self.path))
        try:
            return read_text(self.path, LARGEST)
        except UnreadableError as reason:
            return Unknown(0, f"{self.path.name}: {reason}")

    def looped(self) -> list[str] | None:
        """Return the lines; None if the file cannot be read."""
        text = self.read()
        return text.splitlines(keepends=True) if isinstance(text, str) else None

    def readlines(self) -> Any:
        """Return the lines; Unknown if the file cannot be read."""
        lines = self.looped()
        return Unknown(0, self.path.name) if lines is None else lines

    def close(self) -> None:
        """Do nothing."""

    @property
    def name(self) -> str:
        """Return the path."""
        return str(self.path)


def models(workspace: Workspace) -> dict[str, Callable[..., Any]]:
    """Return models of reading functions; Unknown outside the workspace."""

    def inside(path: Any) -> Path | None:
        place = normal(str(path)) if isinstance(path, str | FilePath) else ""
        return Path(place) if place.startswith("/") and Path(place).is_relative_to(workspace.root) else None

    def opened(path: Any, mode: Any = "r", *_: Any, **__: Any) -> Any:
        place = inside(path)
        reads = mode in ("r", "rt", "rb")
        if place is not None and reads and not place.exists():
            raise FileNotFoundError(2, "No such file or directory", str(place))
        return OpenFile(place) if place is not None and reads else Unknown(0, f"open({path!s:.60})")

    def text(path: Any, *_: Any, **__: Any) -> Any:
        one = opened(path)
        return one.read() if isinstance(one, OpenFile) else one

    def test(kind: str) -> Callable[[Any], Any]:
        def tested(path: Any) -> Any:
            place = inside(path)
            return Unknown(0, f"{kind}({path!s:.60})") if place is None else bool(getattr(place, kind)())

        return tested

    return {
        **listings(inside),
        "configparser.ConfigParser": lambda *_, **__: IniFile(inside),
        "csv.reader": _rows, "io.StringIO": OpenText, "csv.DictReader": _records,
        "builtins.open": opened, "io.open": opened, "codecs.open": opened,
        "pathlib.Path.read_text": text, "pathlib.Path.open": opened,
        **{f"pathlib.Path.{kind}": test(kind) for kind in ("exists", "is_file", "is_dir")},
        "os.path.exists": test("exists"), "os.path.isfile": test("is_file"), "os.path.isdir": test("is_dir"),
        **{f"yaml.{name}": _yaml for name in ("safe_load", "load", "full_load", "unsafe_load")},
        "json.load": _json,
    }  # fmt: skip


class OpenText:
    """The result of `io.StringIO`: a string that is read as a file."""

    readable: ClassVar = frozenset({"read", "readlines", "getvalue", "close"})

    def __init__(self, text: Any = "") -> None:
        if not isinstance(text, str):
            raise OpaqueError("an unknown text")
        self._text = text

    def read(self, *_: Any) -> str:
        """Return the text."""
        return self._text

    getvalue = read

    def looped(self) -> list[str]:
        """Return the lines."""
        return self._text.splitlines(keepends=True)

    readlines = looped

    def close(self) -> None:
        """Do nothing."""


def _rows(source: Any, **given: Any) -> Stream:
    return Stream(iter(_read_rows(source, given)))


def _read_rows(source: Any, given: dict[str, Any]) -> list[list[str]]:
    lines = source.looped() if isinstance(source, OpenFile | OpenText) else source
    if not isinstance(lines, list) or not all(isinstance(one, str) for one in lines):
        raise OpaqueError("unknown lines")
    return list(csv.reader(lines, **given))


def _records(source: Any, fieldnames: Any = None, **given: Any) -> list[dict[str, str]]:
    rows = _read_rows(source, given)
    head, rest = (fieldnames, rows) if fieldnames is not None else (rows[0], rows[1:])
    return [dict(zip(head, row, strict=False)) for row in rest if row]


def _text(source: Any) -> str | None:
    found = source.read() if isinstance(source, OpenFile | OpenText) else source
    return found if isinstance(found, str) else None


def _yaml(source: Any, *_: Any, **__: Any) -> Any:
    text = _text(source)
    if text is None:
        return Unknown(0, "yaml.load")
    try:
        # a copy, because the launch file may change the cached content
        return copy.deepcopy(_kept(content(Setting("", Path(), yaml=text))))
    except (NoYamlError, UnreadableError):
        return Unknown(0, "yaml.load")


def _json(source: Any, *_: Any, **__: Any) -> Any:
    text = _text(source)
    try:
        return Unknown(0, "json.load") if text is None else _kept(json.loads(text))
    except (ValueError, RecursionError):
        return Unknown(0, "json.load")


def _kept(value: Any) -> Any:
    return value if bounded(value) else Unknown(0, "a large file")
