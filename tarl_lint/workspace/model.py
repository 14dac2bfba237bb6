"""The values of a workspace description. Paths are absolute."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

Kind = Literal["catkin", "ament_python", "ament_cmake", "cmake", "unknown"]
INTERFACES: Final = ("msg", "srv", "action")


@dataclass(frozen=True, slots=True)
class Problem:
    """Something that could not be read: the file, a line (0 for the whole file) and the reason.

    `hides` is True if a launch file may start further nodes there. If an included file is not in the workspace,
    `package` is its package, and `given` are the values that it receives. Otherwise, `package` is "". `unreadable`
    is True if nothing of the file could be read.
    """

    file: Path
    line: int
    reason: str
    hides: bool = False
    package: str = ""
    given: tuple[str, ...] = ()
    unreadable: bool = False


def unreadable(file: Path, line: int, reason: str) -> Problem:
    """Return the problem of a file that may start nodes and could not be read at all."""
    return Problem(file, line, reason, hides=True, unreadable=True)


@dataclass(frozen=True, slots=True)
class Executable:
    """A Python program of a package: name for `ros2 run` or `rosrun`, file, and function of the entry point.

    `path` is None if the declared file does not exist.
    """

    name: str
    path: Path | None
    entry: str | None = None
    module: str = ""


@dataclass(frozen=True, slots=True)
class ImportRoot:
    """A top-level module or package that the installation makes importable, with its folder or file."""

    name: str
    path: Path


@dataclass(frozen=True, slots=True)
class Package:
    """A package: a folder with a `package.xml`.

    `compiled` are its C++ programs. `tests` are the programs that are only for tests. `components` are the classes
    of its nodelets and composable nodes. `others` are files in folders named `launch` that may be launch files, but
    do not look like them.
    """

    name: str
    folder: Path
    kind: Kind
    dependencies: tuple[str, ...] = ()
    executables: tuple[Executable, ...] = ()
    modules: tuple[ImportRoot, ...] = ()
    interfaces: tuple[Path, ...] = ()
    configurations: tuple[Path, ...] = ()
    launch_files: tuple[Path, ...] = ()
    parameter_files: tuple[Path, ...] = ()
    problems: tuple[Problem, ...] = ()
    compiled: tuple[str, ...] = ()
    components: tuple[str, ...] = ()
    others: tuple[Path, ...] = ()
    tests: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Hidden:
    """A package that is hidden from the build tools by `marker`, a file such as COLCON_IGNORE."""

    package: Package
    marker: Path


@dataclass(frozen=True, slots=True)
class Workspace:
    """All packages below a folder, sorted by name; of packages with the same name, the first counts.

    A package with a `package.xml` comes before a mere folder of definitions.

    `hidden` are further packages. Hidden packages are found by name and by path, but are not among `packages`.
    `unread` are folders that could not be read, and packages with the name of another package.
    """

    root: Path
    packages: tuple[Package, ...] = ()
    hidden: tuple[Hidden, ...] = ()
    unread: tuple[Problem, ...] = ()

    def package(self, name: str) -> Package | None:
        """Return the package of that name, preferably not a hidden one."""
        return next((one for one in self._all() if one.name == name), None)

    def package_of(self, path: Path) -> Package | None:
        """Return the innermost package that contains a file."""
        around = [one for one in self._all() if path.is_relative_to(one.folder)]
        return max(around, key=lambda one: len(one.folder.parts), default=None)

    def hidden_at(self, path: Path) -> Hidden | None:
        """Return the innermost hidden package that contains a file or folder."""
        around = [one for one in self.hidden if path.is_relative_to(one.package.folder)]
        return max(around, key=lambda one: len(one.package.folder.parts), default=None)

    def marker_of(self, name: str) -> Path | None:
        """Return the file that hides the package of that name, if it is hidden."""
        return next((one.marker for one in self.hidden if one.package.name == name), None)

    def _all(self) -> tuple[Package, ...]:
        return (*self.packages, *(one.package for one in self.hidden))

    def problems(self) -> Iterator[Problem]:
        """Yield everything that could not be read."""
        yield from self.unread
        for one in self.packages:
            yield from one.problems
