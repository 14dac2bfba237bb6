"""Read the Python programs, modules and packages that `CMakeLists.txt` installs. Nothing is executed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.cmake_blocks import Blocks
from tarl_lint.workspace.model import Problem

LARGEST: Final = 500_000  # maximum size of a file (bytes)
MOST: Final = 2_000  # maximum number of words of a variable
LONGEST: Final = 1_000  # maximum length of a word of a variable (characters)
_TOKEN: Final = re.compile(
    r"""\#\[(?P<eq>=*)\[.*?\](?P=eq)\] | \#[^\n]*
        | (?P<word>"(?:[^"\\]|\\.)*" | [^\s()#"]+) | (?P<open>\() | (?P<close>\))""",
    re.VERBOSE | re.DOTALL,
)
_VARIABLE: Final = re.compile(r"\$\{(\w+)\}")
_KEYWORDS: Final = frozenset(
    ["PROGRAMS", "FILES", "TARGETS", "DIRECTORY", "DESTINATION", "RENAME", "PATTERN", "OPTIONAL", "PERMISSIONS",
     "COMPONENT", "USE_SOURCE_PERMISSIONS", "CONFIGURATIONS", "EXCLUDE", "REGEX", "RUNTIME", "LIBRARY", "ARCHIVE",
     "FILES_MATCHING", "SCRIPTS_DESTINATION"]
)  # fmt: skip
# folders in which `ros2 run` and `rosrun` look for programs
_PROGRAMS: Final = re.compile(r"BIN_DESTINATION|^lib/|^bin$")


@dataclass(frozen=True, slots=True)
class Command:
    """A call in a CMake file, with known variables replaced."""

    name: str
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Cmake:
    """The installed programs (file, installed name) and Python packages (name, folder) of a package."""

    programs: tuple[tuple[str, str], ...] = ()
    python_packages: tuple[tuple[str, str], ...] = ()
    uses_setup: bool = False
    problems: tuple[Problem, ...] = ()


def cmake(folder: Path, package: str) -> Cmake:
    """Return what the `CMakeLists.txt` in a folder installs; empty if there is no such file."""
    path = folder / "CMakeLists.txt"
    try:
        text = read_text(path, LARGEST) if path.is_file() else ""
    except UnreadableError as reason:
        return Cmake(problems=(Problem(path, 0, str(reason)),))
    programs: dict[str, str] = {}
    packages: dict[str, str] = {}
    uses_setup = False
    for command in commands(text, folder, package):
        if command.name == "catkin_python_setup":
            uses_setup = True
        elif command.name in ("install", "catkin_install_python"):
            programs |= dict(_programs(folder, command.words))
        elif command.name == "ament_python_install_package" and command.words:
            name, *rest = command.words
            place = rest[rest.index("PACKAGE_DIR") + 1] if "PACKAGE_DIR" in rest[:-1] else name
            packages[name] = place
    return Cmake(tuple(sorted(programs.items())), tuple(sorted(packages.items())), uses_setup)


def commands(text: str, folder: Path, package: str) -> Iterator[Command]:
    """Yield the commands of a CMake text. `set` and `file(GLOB)` define variables; macros and loops are expanded."""
    here = str(folder)
    variables = {"PROJECT_NAME": [package], "CMAKE_CURRENT_SOURCE_DIR": [here], "PROJECT_SOURCE_DIR": [here],
                 "CMAKE_SOURCE_DIR": [here], "CMAKE_CURRENT_LIST_DIR": [here]}  # fmt: skip
    for name, replaced in Blocks(_all_replaced, variables).run(list(_calls(text))):
        if name == "set" and replaced:
            variables[replaced[0]] = [word[:LONGEST] for word in replaced[1 : MOST + 1]]
        elif name == "file" and len(replaced) > 1 and replaced[0] in ("GLOB", "GLOB_RECURSE"):
            variables[replaced[1]] = list(_globbed(folder, replaced[2:], deep=replaced[0] != "GLOB"))
        yield Command(name, replaced)


def _calls(text: str) -> Iterator[tuple[str, list[str]]]:
    name, depth, words = "", 0, list[str]()
    for token in _TOKEN.finditer(text):
        if token["open"]:
            depth += 1
        elif token["close"]:
            depth -= 1
            if depth <= 0:
                yield name.lower(), words
                depth, words = 0, []
        elif token["word"] and depth:
            words.append(token["word"])
        elif token["word"]:
            name = token["word"]


def _all_replaced(words: Sequence[str], variables: dict[str, list[str]]) -> tuple[str, ...]:
    return tuple(piece for word in words for piece in _replaced(word, variables))


def _replaced(word: str, variables: dict[str, list[str]]) -> list[str]:
    """Replace the variables in a word; a variable that is the whole word can become several words."""
    quoted = word.startswith('"')
    word = word.strip('"') if quoted else word
    alone = _VARIABLE.fullmatch(word)
    if alone is not None and not quoted:
        return variables.get(alone[1], [word])
    text = _VARIABLE.sub(lambda found: ";".join(variables.get(found[1], [found[0]])), word)
    return [text] if quoted else [part for part in text.split(";") if part]


def _globbed(folder: Path, patterns: tuple[str, ...], *, deep: bool) -> Iterator[str]:
    for pattern in patterns:
        relative = pattern.removeprefix(f"{folder}/")
        if (
            relative.startswith("/")
            or ".." in relative
            or relative in ("RELATIVE", "CONFIGURE_DEPENDS", str(folder))
        ):
            continue
        try:
            found = folder.rglob(relative) if deep else folder.glob(relative)
            yield from sorted(str(path.relative_to(folder)) for path in found)
        except (ValueError, OSError, NotImplementedError):
            continue


def _programs(folder: Path, words: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield the files that an `install` command installs as programs: named files, or all files of a folder."""
    groups: dict[str, list[str]] = {}
    within: list[str] = []
    for word in words:
        if word in _KEYWORDS:
            within = groups.setdefault(word, [])
        else:
            within.append(word.removeprefix(f"{folder}/"))
    renamed = next(iter(groups.get("RENAME", ())), "")
    yield from ((one, renamed or Path(one).name) for one in groups.get("PROGRAMS", ()))
    if _PROGRAMS.search(" ".join(groups.get("DESTINATION", ())[:1])):
        inside = [path for one in groups.get("DIRECTORY", ()) for path in sorted((folder / one).glob("*"))]
        for path in (*inside, *(folder / one for one in groups.get("FILES", ()))):
            if path.is_file() and path.is_relative_to(folder):
                yield str(path.relative_to(folder)), path.name
