"""Find the topics that the C++ source of a node names as literals in calls, without any analysis of the code.

The topics of C++ nodes are drawn and composed, so that a chain does not end at a C++ node. Rules treat these topics
as possible, never as certain.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Final

from tarl_lint.files import shown
from tarl_lint.model import Span
from tarl_lint.system.cpp_qos import after_name
from tarl_lint.system.image_transport import CAMERA, IMAGE
from tarl_lint.system.model import Endpoint, Role
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.cmake import EXECUTABLES, commands, renamed
from tarl_lint.workspace.model import Package

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)
_SUFFIXES: Final = (".cpp", ".cc", ".cxx", ".c++")
_COMMENT: Final = re.compile(r"//[^\n]*|/\*.*?\*/|(\"(?:[^\"\\\n]|\\.)*\")", re.DOTALL)
_CALL: Final = re.compile(
    r"(?:(?P<who>\w+)(?:\(\))?\s*(?:\.|->|::)\s*)?"
    r"\b(?P<call>advertise(?:Camera)?|create_(?:camera_)?publisher|subscribe(?:Camera)?|create_(?:camera_)?subscription)"
    r"\s*(?:<\s*(?P<type>[\w:]+)[^;(]{0,200}?>)?\s*\((?:\s*[\w.>()-]+\s*,)?\s*\"(?P<name>[\w/~]+)\""
)
# finds the names of objects of image_transport: `ImageTransport it(nh)`,
# `it = std::make_shared<image_transport::ImageTransport>(nh)`
_IMAGES: Final = re.compile(
    r"\bImageTransport>?\s+(\w+)|\b(\w+)\s*(?:=|\.reset\s*\()[^;=]{0,80}\bImageTransport\b"
)
_PRIVATE: Final = re.compile(
    r"\b(\w+)\s*[({]\s*\"~\"|\b(\w+)\s*=\s*(?:ros::)?NodeHandle\s*\(\s*\"~\""
)  # handles


def named_topics(package: Package, executable: str) -> tuple[Endpoint, ...]:
    """Return the topics that the sources of a C++ program name, in the order of the files."""
    return tuple(end for path in _sources(package, executable) for end in _ends(path))


def compiled(package: Package) -> tuple[str, ...]:
    """Return the names of the C++ programs of a package, in the order of CMakeLists.txt."""
    return tuple(dict.fromkeys(name for name, _ in _programs(package.folder, package.name)))


def is_compiled(package: Package, executable: str) -> bool:
    """Return whether CMakeLists.txt states the C++ files of a program."""
    return bool(_sources(package, executable))


def _sources(package: Package, executable: str) -> list[Path]:
    """Return the files of a program, as CMakeLists.txt lists them."""
    return [path for name, path in _programs(package.folder, package.name) if name == executable]


@cache
def _programs(folder: Path, package: str) -> tuple[tuple[str, Path], ...]:
    try:
        text = read_text(folder / "CMakeLists.txt", LARGEST)
    except UnreadableError:
        return ()
    found: list[tuple[str, Path]] = []
    names: dict[str, str] = {}
    for command in commands(text, folder, package):
        if command.name in EXECUTABLES and command.words:
            name, *files = command.words
            found += [(name, folder / file) for file in files if file.endswith(_SUFFIXES)]
        else:
            names |= renamed(command)
    inside = [(names.get(name, name), path) for name, path in found if path.is_relative_to(folder)]
    return tuple(one for one in inside if one[1].is_file())


@cache
def _ends(path: Path) -> tuple[Endpoint, ...]:
    try:
        text = read_text(path, LARGEST)
    except UnreadableError:
        return ()
    return tuple(_named(path, _COMMENT.sub(_blank, text)))


def _blank(found: re.Match[str]) -> str:
    """Return a string unchanged, and a comment as spaces, so that line numbers stay the same."""
    return found[1] or re.sub(r"[^\n]", " ", found[0])


def _named(path: Path, text: str) -> Iterator[Endpoint]:
    images = {one for pair in _IMAGES.findall(text) for one in pair if one} | {"image_transport"}
    # usual names of a member that is declared in a header
    images |= {"it", "it_"} if "image_transport" in text else set()
    private = {one for pair in _PRIVATE.findall(text) for one in pair if one}
    for found in _CALL.finditer(text):
        who, name = found["who"] or "", found["name"]
        if (who in private or "priv" in who or who in ("pnh", "pnh_", "nh_p")) and not name.startswith(
            ("/", "~")
        ):
            name = f"~{name}"
        line = text.count("\n", 0, found.start("call")) + 1
        column = found.start("call") - text.rfind("\n", 0, found.start("call"))
        span = Span(shown(path), line, column, line, column + len(found["call"]))
        role: Role = (
            "publishes" if "advertise" in found["call"] or "publisher" in found["call"] else "subscribes"
        )
        kind = _of_message(found["type"] or "", text)
        if who in images:
            kind = CAMERA if "amera" in found["call"] else IMAGE
        qos = after_name(text, found.end()) if found["call"].startswith("create_") else None
        yield Endpoint(role, (name,), kind, span, qos)


def _of_message(written: str, text: str) -> str:
    """Return the name of a type of messages; "" for an alias, which stands for another type.

    `std_msgs::msg::Bool` and `std_msgs::Bool` are not aliases. `arm::Grip` is not an alias either if the file
    includes `arm/Grip.h`. A name without a package is an alias if the file defines it as an alias.
    """
    package, _, name = written.removeprefix("::").rpartition("::")
    first = package.partition("::")[0]
    if not package:
        alias = rf"\busing\s+{re.escape(name)}\s*=|\btypedef\b[^;]*\b{re.escape(name)}\s*;"
        return "" if not name or re.search(alias, text) else name
    known = package.endswith("::msg") or first.endswith("_msgs")
    return (
        name if known or re.search(rf"#include\s*[<\"]{re.escape(f'{first}/{name}')}\.h[>\"]", text) else ""
    )
