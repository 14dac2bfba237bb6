"""Read the Python programs, modules and packages that `CMakeLists.txt` installs. Nothing is executed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.cmake_blocks import Blocks, Call
from tarl_lint.workspace.model import Problem

LARGEST: Final = 500_000  # maximum size of a file (bytes)
MOST: Final = 2_000  # maximum number of words of a variable
LONGEST: Final = 1_000  # maximum length of a word of a variable (characters)
_TOKEN: Final = re.compile(
    r"""\#\[(?P<eq>=*)\[.*?\](?P=eq)\] | \#[^\n]*
        | (?P<word>"(?:[^"\\]|\\.)*" | [^\s()#"]+) | (?P<open>\() | (?P<close>\)) | (?P<stray>")""",
    re.VERBOSE | re.DOTALL,
)
_VARIABLE: Final = re.compile(r"\$\{(\w+)\}")
# commands that build a C++ program
EXECUTABLES: Final = (
    "add_executable",
    "ament_auto_add_executable",
    "cuda_add_executable",
    "rosbuild_add_executable",
)
# variables of conditions under which tests are built
_TESTING: Final = frozenset({"BUILD_TESTING", "CATKIN_ENABLE_TESTING"})
# matches a CMake file that builds or installs programs
_BUILDS: Final = re.compile(rf"\bPROGRAMS\b|catkin_install_python|{'|'.join(EXECUTABLES)}", re.IGNORECASE)
# folders of the interfaces that commands of ROS 1 declare
_PLACES: Final = {"add_message_files": "msg", "add_service_files": "srv", "add_action_files": "action"}
_INTERFACES: Final = frozenset({"rosidl_generate_interfaces", *_PLACES})
# pairs of commands: the first begins a block that the second must close
_BLOCKS: Final = {"if": "endif", "foreach": "endforeach", "while": "endwhile", "macro": "endmacro",
                  "function": "endfunction"}  # fmt: skip
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
    line: int = 0


@dataclass(frozen=True, slots=True)
class Cmake:
    """The installed programs (file, installed name) and Python packages (name, folder) of a package.

    `compiled` lists its C++ programs, and `tests` lists the programs that the package builds only for tests.
    `components` lists the classes of its composable nodes, and `configurations` lists the `.cfg` files that the
    package declares.
    """

    programs: tuple[tuple[str, str], ...] = ()
    python_packages: tuple[tuple[str, str], ...] = ()
    uses_setup: bool = False
    problems: tuple[Problem, ...] = ()
    compiled: tuple[str, ...] = ()
    components: tuple[str, ...] = ()
    configurations: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()


def cmake(folder: Path, package: str) -> Cmake:
    """Return what the `CMakeLists.txt` in a folder installs; empty if there is no such file."""
    path = folder / "CMakeLists.txt"
    try:
        text = read_text(path, LARGEST) if path.is_file() else ""
    except UnreadableError as reason:
        return Cmake(problems=(Problem(path, 0, str(reason)),))
    found = _Build(folder, path)
    for command in commands(text, folder, package):
        found.take(command)
    found.problems += [Problem(path, line, reason) for line, reason in _unclosed(text)]
    return Cmake(
        tuple(sorted(found.programs.items())),
        tuple(sorted(found.packages.items())),
        found.uses_setup,
        tuple(dict.fromkeys(found.problems)),
        tuple(sorted({found.renamed.get(one, one) for one in found.compiled})),
        tuple(sorted(found.components)),
        tuple(sorted(found.configurations)),
        tuple(sorted(found.tests)),
    )


@dataclass
class _Build:
    """Collects what the commands of a `CMakeLists.txt` build and install."""

    folder: Path
    path: Path
    programs: dict[str, str] = field(default_factory=dict)
    packages: dict[str, str] = field(default_factory=dict)
    uses_setup: bool = False
    compiled: set[str] = field(default_factory=set)
    tests: set[str] = field(default_factory=set)
    components: set[str] = field(default_factory=set)
    configurations: set[str] = field(default_factory=set)
    renamed: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    conditions: list[bool] = field(default_factory=list)  # for each enclosing `if`, whether it is for tests

    def take(self, command: Command) -> None:
        """Take one command into account."""
        name, words = command.name, command.words
        if name == "if":
            self.conditions.append(not _TESTING.isdisjoint(words))
        elif name == "endif" and self.conditions:
            self.conditions.pop()
        elif name == "catkin_python_setup":
            self.uses_setup = True
        elif name in ("install", "catkin_install_python"):
            self.programs |= dict(_programs(self.folder, self._known(command, _sources(words))))
        elif name == "ament_python_install_package" and self._known(command, words[:1]):
            first, *rest = words
            self.packages[first] = _after(rest, "PACKAGE_DIR", first)
        elif name in EXECUTABLES or name.startswith("rclcpp_components_register_node"):
            self._compiled(command)
        elif "gtest" in name or "gmock" in name:
            self.tests |= set(words[:1])
        else:
            self.renamed |= renamed(command)
            self._declared(command)

    def _declared(self, command: Command) -> None:
        """Take the files of configurations and interfaces that a command declares into account."""
        name, words = command.name, command.words
        if name in ("add_subdirectory", "include") and words and not any(self.conditions):
            self._elsewhere(command)
        elif name == "generate_dynamic_reconfigure_options":
            self.configurations |= {one for one in words if self._exists(command, one)}
        elif name in _INTERFACES:
            place = _after(words, "DIRECTORY", _PLACES.get(name, ""))
            for one in words:
                if one.endswith((".msg", ".srv", ".action")):
                    self._exists(command, f"{place}/{one}" if place else one)

    def _compiled(self, command: Command) -> None:
        words = self._known(command, command.words)
        if command.name in EXECUTABLES:
            if words and words[0] == command.words[0] and not {"IMPORTED", "ALIAS"} & set(words):
                (self.tests if any(self.conditions) else self.compiled).add(words[0])
            return
        self.components |= {one for one in words if "::" in one}
        if "EXECUTABLE" in words[:-1]:
            self.compiled.add(_after(words, "EXECUTABLE"))

    def _known(self, command: Command, words: Sequence[str]) -> tuple[str, ...]:
        """Return the words without unknown variables; record a problem for each other word."""
        unknown = [one for one in words if _names_unknown(one)]
        for one in unknown:
            self.problems.append(
                Problem(self.path, command.line, f"{command.name}: the value of {one} is not known")
            )
        return tuple(one for one in words if one not in unknown)

    def _elsewhere(self, command: Command) -> None:
        """Record a problem if another file of the package builds or installs programs."""
        path = self.folder / command.words[0]
        path = path / "CMakeLists.txt" if command.name == "add_subdirectory" else path
        if not path.is_file() or not path.is_relative_to(self.folder):
            return
        try:
            text = read_text(path, LARGEST)
        except UnreadableError:
            text = "PROGRAMS"
        if _BUILDS.search(text):
            reason = f"{command.name}: {path.relative_to(self.folder)} is not read"
            self.problems.append(Problem(self.path, command.line, reason))

    def _exists(self, command: Command, file: str) -> bool:
        """Return whether a declared file exists; record a problem if not."""
        path = self.folder / file
        if _VARIABLE.search(file) or not path.is_relative_to(self.folder):
            return False
        if not path.is_file():
            self.problems.append(Problem(self.path, command.line, f"{file} is declared, but does not exist"))
        return path.is_file()


def _names_unknown(word: str) -> bool:
    """Return whether a word has an unknown variable; install folders do not count."""
    return any(
        "DESTINATION" not in one and not one.startswith("CMAKE_INSTALL_") for one in _VARIABLE.findall(word)
    )


def _sources(words: tuple[str, ...]) -> tuple[str, ...]:
    """Return the program words of an `install` command, with keywords and place."""
    if words[:1] == ("TARGETS",):
        return ()
    if "PROGRAMS" in words or _PROGRAMS.search(_after(words, "DESTINATION")):
        return words
    return ()


def _after(words: Sequence[str], keyword: str, default: str = "") -> str:
    """Return the word after a keyword."""
    return words[words.index(keyword) + 1] if keyword in words[:-1] else default


def renamed(command: Command) -> dict[str, str]:
    """Return target → the file name that a command gives it; empty without one."""
    words = command.words
    if command.name != "set_target_properties" or "OUTPUT_NAME" not in words[:-1]:
        return {}
    return {words[0]: _after(words, "OUTPUT_NAME")}


def _unclosed(text: str) -> Iterator[tuple[int, str]]:
    """Yield the lines of calls, texts and blocks that are never closed."""
    depth, start = 0, 0
    for line, token in _tokens(text):
        if token["stray"]:
            yield line, "a quoted text is not closed"
            return
        start = line if token["open"] and not depth else start
        depth = max(depth + bool(token["open"]) - bool(token["close"]), 0)
    if depth:
        yield start, "a parenthesis is not closed"
    opened: list[Call] = []
    for call in _calls(text):
        if call.name in _BLOCKS:
            opened.append(call)
        elif opened and call.name == _BLOCKS[opened[-1].name]:
            opened.pop()
    yield from ((call.line, f"{call.name}() is not closed") for call in opened[:1])


def commands(text: str, folder: Path, package: str) -> Iterator[Command]:
    """Yield the commands of a CMake text, with macros and loops expanded."""
    here = str(folder)
    variables = {"PROJECT_NAME": [package], "CMAKE_CURRENT_SOURCE_DIR": [here], "PROJECT_SOURCE_DIR": [here],
                 "CMAKE_SOURCE_DIR": [here], "CMAKE_CURRENT_LIST_DIR": [here]}  # fmt: skip
    for name, replaced, line in Blocks(_all_replaced, variables).run(list(_calls(text))):
        if name == "set" and replaced:
            variables[replaced[0]] = [word[:LONGEST] for word in replaced[1 : MOST + 1]]
        elif name == "list" and replaced[:1] == ("APPEND",) and len(replaced) > 1:
            more = [word[:LONGEST] for word in replaced[2:]]
            variables[replaced[1]] = (variables.get(replaced[1], []) + more)[:MOST]
        elif name == "file" and len(replaced) > 1 and replaced[0] in ("GLOB", "GLOB_RECURSE"):
            variables[replaced[1]] = list(_globbed(folder, replaced[2:], deep=replaced[0] != "GLOB"))
        yield Command(name, replaced, line)


def _calls(text: str) -> Iterator[Call]:
    name, depth, words = "", 0, list[str]()
    started = 1
    for line, token in _tokens(text):
        if token["open"]:
            depth += 1
        elif token["close"]:
            depth -= 1
            if depth <= 0:
                yield Call(name.lower(), words, started)
                depth, words = 0, []
        elif token["word"] and depth:
            words.append(token["word"])
        elif token["word"]:
            name, started = token["word"], line


def _tokens(text: str) -> Iterator[tuple[int, re.Match[str]]]:
    """Yield the tokens of a text, each with its line."""
    line, last = 1, 0
    for token in _TOKEN.finditer(text):
        line += text.count("\n", last, token.start())
        last = token.start()
        yield line, token


def _all_replaced(words: Sequence[str], variables: dict[str, list[str]]) -> tuple[str, ...]:
    return tuple(piece for word in words for piece in _replaced(word, variables))


def _replaced(word: str, variables: dict[str, list[str]]) -> list[str]:
    """Replace the variables in a word, which may give several words."""
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
    """Yield the programs that an `install` command installs."""
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
