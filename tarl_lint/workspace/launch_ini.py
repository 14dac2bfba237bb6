"""`configparser` in Python launch files: the sections of INI files of the workspace."""

from __future__ import annotations

import configparser
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.python.elements import items
from tarl_lint.workspace.python.values import OpaqueError

LARGEST = 100_000  # maximum size of a file (bytes)


class IniFile:
    """The result of `ConfigParser()`.

    Its methods raise OpaqueError for files outside the workspace and files that are not INI files.
    """

    readable: ClassVar = frozenset({
        "read", "read_string", "sections", "has_section", "has_option", "options", "items", "get", "getint",
        "getfloat", "getboolean",
    })  # fmt: skip

    def __init__(self, inside: Callable[[Any], Path | None]) -> None:
        self._inside = inside
        self._parsed = configparser.ConfigParser(interpolation=None)

    def read(self, names: Any, *_: Any, **__: Any) -> list[str]:
        """Read files; return the existing ones. Raise OpaqueError outside the workspace."""
        found = []
        for name in [names] if not isinstance(names, list | tuple) else names:
            place = self._inside(name)
            if place is None:
                raise OpaqueError("a file outside the workspace")
            if place.is_file():
                self.read_string(_text(place))
                found.append(str(name))
        return found

    def read_string(self, text: Any, *_: Any) -> None:
        """Read a string. Raise OpaqueError if it is not plain."""
        try:
            self._parsed.read_string(text)
        except configparser.Error as error:
            raise OpaqueError(str(error)) from None
        if any("%" in value for name in self._parsed.sections() for _, value in self._parsed.items(name)):
            raise OpaqueError("values that refer to others")

    def __getattr__(self, name: str) -> Any:
        if name not in self.readable:
            raise AttributeError(name)
        method = getattr(self._parsed, name)

        def called(*args: Any, **given: Any) -> Any:
            try:
                return method(*args, **given)
            except configparser.Error as error:
                raise OpaqueError(str(error)) from None

        return called

    def section(self, name: Any) -> dict[str, str]:
        """Return a section as a dict. Raises KeyError if there is none."""
        return dict(self._parsed[name])

    def looped(self) -> list[str] | None:
        """Return the names of the sections."""
        return items(list(self._parsed))


def _text(place: Path) -> str:
    try:
        return read_text(place, LARGEST)
    except UnreadableError as reason:
        raise OpaqueError(str(reason)) from None
