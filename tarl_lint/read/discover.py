"""Find the files to analyse and their module names; count skipped files for the report."""

# ruff: noqa: PTH100, PTH110, PTH112, PTH120, PTH123
# Paths are strings here: trees are large, and Path objects cost several times as much.

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from tarl_lint.errors import UsageError
from tarl_lint.files import shown
from tarl_lint.read import gitignore
from tarl_lint.read.declared_entry_points import Declarations
from tarl_lint.read.gitignore import Ignore
from tarl_lint.read.layout import Layout
from tarl_lint.settings.config import Config, Stdin, repository_root

_NEVER = frozenset({"__pycache__", "node_modules", "site-packages"})
_COLCON = frozenset({"build", "install", "log"})
_MARKERS = ("COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE", "pyvenv.cfg", ".catkin")
_CPP = (".cpp", ".cc", ".cxx")
_CPP_NODE = (
    b"ros::init(",
    b"ros::NodeHandle",
    b"rclcpp::init(",
    b"rclcpp::Node",
    b"RCLCPP_COMPONENTS_REGISTER_NODE",
)
_LAUNCH = (".launch", ".launch.xml", ".launch.py", ".launch.yaml", ".launch.yml")
_ENOUGH = 200_000  # number of bytes that are read from a file that is only counted


class SourceFile(NamedTuple):
    """A file to analyse: its place, its displayed path, its dotted name, whether it is `__init__.py`.

    `started` are the entry points in this file that its package declares.
    """

    path: Path
    shown: str
    name: str
    is_package: bool
    started: tuple[str, ...] = ()


@dataclass(frozen=True)
class Notes:
    """What was found but not analysed: counts, and unreadable directories. `unread_nodes` are nodes of launch files."""

    cpp_nodes: int = 0
    remapping_launch_files: int = 0
    duplicate_links: int = 0
    unreadable: tuple[str, ...] = ()
    unread_nodes: int = 0


@dataclass(frozen=True)
class Discovery:
    """The files of a run, sorted by displayed path, and notes on skipped files."""

    files: tuple[SourceFile, ...] = ()
    notes: Notes = field(default_factory=Notes)


def find(paths: Sequence[Path], config: Config, stdin: Stdin | None = None) -> Discovery:
    """Return the Python files at and below `paths`. A path in `paths` itself is included even if patterns exclude it.

    Raises UsageError if a path does not exist and its text does not come from standard input.
    """
    walk = _Walk(config)
    for path in paths:
        if path.is_dir():
            walk.tree(_absolute(path))
        elif _exists(path) or (stdin is not None and path == stdin.path):
            walk.take(_absolute(path))
        else:
            raise UsageError(_missing(path))
    walk.follow_links()
    return walk.discovery()


def excluded(path: Path, config: Config) -> bool:
    """Return whether the setting `exclude` matches a file or a folder around it."""
    root = _absolute(config.root or Path.cwd())
    patterns = gitignore.parse(root, config.exclude)
    place, above = _absolute(path), root.rstrip("/") + "/"
    if not place.startswith(above):
        return False
    parts = place[len(above) :].split("/")
    places = [above + "/".join(parts[:depth]) for depth in range(1, len(parts) + 1)]
    return any(gitignore.ignored(one, (patterns,), is_directory=one != place) for one in places)


class _Walk:
    """One search. Links are followed last, so that their targets take precedence."""

    def __init__(self, config: Config) -> None:
        root = _absolute(config.root or Path.cwd())
        self._excluded = gitignore.parse(root, config.exclude)
        self._seen: set[str] = set()
        self._files: dict[str, str] = {}
        self._links: list[tuple[str, tuple[Ignore, ...]]] = []
        self._cpp = self._launch = self._duplicates = 0
        self._unreadable: list[str] = []

    def tree(self, directory: str) -> None:
        """Search a directory given by the user."""
        self._search(directory, _ignores_above(directory))

    def take(self, path: str, real: str = "") -> None:
        """Add a file, if it was not found before under another name.

        `real` is the path of the file without links, if known.
        """
        real = real or os.path.realpath(path)
        if real in self._files and self._files[real] != path:
            self._duplicates += 1
        self._files.setdefault(real, path)

    def follow_links(self) -> None:
        """Search the targets of links, except targets that were reached without the link."""
        while self._links:
            path, ignores = self._links.pop(0)
            if not os.path.isdir(path):
                self.take(path)
            elif os.path.realpath(path) in self._seen or _leads_above_itself(path):
                self._duplicates += 1
            else:
                self._search(path, ignores)

    def discovery(self) -> Discovery:
        """Return the result of the search."""
        layout, here = Layout(), _absolute(Path()).rstrip("/") + "/"
        declared = Declarations()
        files = []
        for path in self._files.values():
            name, is_package = layout.module(path)
            started = declared.of(path, name)
            files.append(SourceFile(Path(path), path.removeprefix(here), name, is_package, started))
        notes = Notes(self._cpp, self._launch, self._duplicates, tuple(sorted(self._unreadable)))
        return Discovery(tuple(sorted(files, key=lambda f: f.shown)), notes)

    def _search(self, top: str, ignores: tuple[Ignore, ...]) -> None:
        pending = [(top, os.path.realpath(top), ignores)]
        while pending:
            directory, real, above = pending.pop()
            if real in self._seen:
                continue
            self._seen.add(real)
            entries = self._entries(directory)
            inside = above + _ignore_file(directory)
            for entry in entries:
                if self._left_out(entry, inside):
                    continue
                if entry.is_symlink():
                    self._links += [(entry.path, inside)] if _is_directory(entry) or _is_python(entry) else []
                elif _is_directory(entry):
                    pending.append((entry.path, _below(real, entry), inside))
                else:
                    self._file(entry, _below(real, entry))

    def _entries(self, directory: str) -> list[os.DirEntry[str]]:
        try:
            with os.scandir(directory) as found:
                return sorted(found, key=lambda entry: entry.name)
        except OSError:
            self._unreadable.append(shown(Path(directory)))
            return []

    def _left_out(self, entry: os.DirEntry[str], ignores: tuple[Ignore, ...]) -> bool:
        is_directory = _is_directory(entry)
        if is_directory and _not_ours(entry.path, entry.name):
            return True
        return gitignore.ignored(entry.path, (*ignores, self._excluded), is_directory=is_directory)

    def _file(self, entry: os.DirEntry[str], real: str) -> None:
        if _is_python(entry):
            self.take(entry.path, real)
        if entry.name.endswith(_CPP):
            self._cpp += _mentions(entry.path, _CPP_NODE)
        elif entry.name.endswith(_LAUNCH):
            self._launch += _mentions(entry.path, (b"remap",))


def _below(directory: str, entry: os.DirEntry[str]) -> str:
    """Return the real path of an entry that is not a link and lies in a directory that was reached without links."""
    return f"{directory.rstrip('/')}/{entry.name}"


def _absolute(path: Path) -> str:
    return os.path.abspath(path)


def _not_ours(path: str, name: str) -> bool:
    """Return whether a directory was created by a tool: hidden directories, virtual environments, colcon's output."""
    if name.startswith(".") or name in _NEVER:
        return True
    if name in _COLCON and not os.path.exists(f"{path}/__init__.py"):
        return True
    return any(os.path.exists(f"{path}/{marker}") for marker in _MARKERS)


def _leads_above_itself(path: str) -> bool:
    """Return whether a link leads to a directory that contains the link, which would be an endless loop."""
    parent = os.path.realpath(os.path.dirname(path))
    target = os.path.realpath(path)
    return parent == target or parent.startswith(target.rstrip("/") + "/")


def _exists(path: Path) -> bool:
    """Return whether a path exists; a circular link does not."""
    try:
        return path.exists()
    except OSError:  # raised for circular links by Python 3.12 and older
        return False


def _is_directory(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:  # circular link
        return False


def _is_python(entry: os.DirEntry[str]) -> bool:
    """Return whether a file is Python by its extension or, without one, by its first line."""
    try:
        if not entry.is_file():
            return False
    except OSError:
        return False
    return entry.name.endswith(".py") or ("." not in entry.name and _has_python_shebang(entry.path))


def _has_python_shebang(path: str) -> bool:
    first = _head(path, 120).split(b"\n", 1)[0]
    return first.startswith(b"#!") and b"python" in first


def _mentions(path: str, words: tuple[bytes, ...]) -> bool:
    data = _head(path, _ENOUGH)
    return any(word in data for word in words)


def _head(path: str, size: int) -> bytes:
    """Return the first bytes of a regular file; empty for other files, since opening a named pipe would block."""
    if not Path(path).is_file():
        return b""
    try:
        with open(path, "rb") as file:
            return file.read(size)
    except OSError:
        return b""


def _ignore_file(directory: str) -> tuple[Ignore, ...]:
    text = _head(f"{directory}/.gitignore", _ENOUGH).decode("utf-8", errors="replace")
    return (gitignore.parse(directory, text.splitlines()),) if text else ()


def _ignores_above(directory: str) -> tuple[Ignore, ...]:
    """Return the .gitignore files between the top of the repository and a directory, outermost first."""
    return tuple(ignore for place in _above(directory) for ignore in _ignore_file(place))


def _above(directory: str) -> Iterator[str]:
    start = Path(directory)
    top = repository_root(start)
    if top is not None and top != start:
        relative = start.relative_to(top).parts
        yield from (str(top.joinpath(*relative[:depth])) for depth in range(len(relative)))


def _missing(path: Path) -> str:
    """Return the message for a missing path, with a suggestion."""
    import difflib  # imported only after a mistake

    if path.is_symlink():
        target = path.readlink()
        return f"{path.as_posix()} is a broken link to {target}: name the file itself."
    parent = path.parent
    if not parent.is_dir():
        return f"{path.as_posix()}: no such file or directory, and no directory {parent.as_posix()} either."
    close = difflib.get_close_matches(path.name, [p.name for p in parent.iterdir()], n=1)
    hint = f": did you mean {(parent / close[0]).as_posix()}?" if close else "."
    return f"{path.as_posix()}: no such file or directory{hint}"
