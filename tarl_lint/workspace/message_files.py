"""Read the fields of messages that packages of the workspace define in `msg` folders."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Final

from tarl_lint.message_fields import ALL_FIELDS
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.model import Workspace

MOST: Final = 100_000  # maximum size of a message definition (bytes)
_FIELD: Final = re.compile(r"\s*([A-Za-z][\w/]*)(?:<=\d+)?(\[[^\]]*\])?\s+([A-Za-z]\w*)")
_SECTIONS: Final = {".srv": ("Request", "Response"), ".action": ("Goal", "Result", "Feedback")}
_SEPARATOR: Final = re.compile(r"^---[^\n]*$", re.MULTILINE)
_STANDARD: Final = frozenset(["std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs"])


def fields(types: Iterable[str], workspace: Workspace) -> Mapping[str, Mapping[str, str]]:
    """Return the fields of message types `package/Name` and of the types in them, for types that the workspace defines.

    Each field is given with the name of its type; "" if the type has no fields or is an array. Types of standard
    packages have no package in their names.
    """
    found: dict[str, Mapping[str, str]] = {}
    pending = sorted(set(types))
    while pending:
        kind = pending.pop()
        text = "" if kind in found else _definition(kind, workspace)
        if text:
            found[kind] = parsed(text, kind.partition("/")[0])
            pending += sorted(one for one in found[kind].values() if "/" in one)
    return found


def parsed(text: str, package: str) -> Mapping[str, str]:
    """Return the fields and constants of a definition, each with its type or ""; `name[]` are elements of an array."""
    found: dict[str, str] = {}
    for line in text.splitlines():
        match = _FIELD.match(line.partition("#")[0])
        if match is not None:
            kind, array, name = match.groups()
            found[name] = "" if array else _named(kind, package)
            if array and _named(kind, package):
                found[f"{name}[]"] = _named(kind, package)
    return found


def _named(kind: str, package: str) -> str:
    first, slash, last = kind.partition("/")
    if kind == "Header" or (slash and first in _STANDARD):
        name = last or kind
        return name if name in ALL_FIELDS else ""
    return kind if slash else f"{package}/{kind}" if kind[0].isupper() else ""


def _definition(kind: str, workspace: Workspace) -> str:
    """Return the text of a definition; "" if the workspace has none or it cannot be read.

    `Name.Part` is a part of a service or action. In ROS 1, the goal of `Reach.action` is also a message `ReachGoal`.
    """
    package, _, name = kind.partition("/")
    owner = workspace.package(package)
    files = owner.interfaces if owner is not None else ()
    name, _, part = name.partition(".")
    if not part:
        whole = next((one for one in files if one.stem == name and one.suffix == ".msg"), None)
        if whole is not None:
            return _text(whole)
        part = next((one for one in _SECTIONS[".action"] if name.endswith(one)), "")
        name = name.removesuffix(part)
    for path in files:
        parts = _SECTIONS.get(path.suffix, ())
        if path.stem == name and part in parts:
            sections = _SEPARATOR.split(_text(path))
            return sections[parts.index(part)] if len(sections) == len(parts) else ""
    return ""


def _text(path: Path) -> str:
    try:
        return read_text(path, MOST)
    except UnreadableError:
        return ""
