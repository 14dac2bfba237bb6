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
    """Something that could not be read: the file, a line (0 for the whole file) and the reason."""

    file: Path
    line: int
    reason: str


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
    """A package: a folder with a `package.xml`."""

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


@dataclass(frozen=True, slots=True)
class Workspace:
    """All packages below a folder, sorted by name; of packages with the same name, the first counts.

    `hidden` maps the names of further packages to the file, such as COLCON_IGNORE, that hides each of them.
    """

    root: Path
    packages: tuple[Package, ...] = ()
    hidden: tuple[tuple[str, Path], ...] = ()

    def package(self, name: str) -> Package | None:
        """Return the package of that name."""
        return next((one for one in self.packages if one.name == name), None)

    def absence(self, name: str) -> str:
        """Return a clause that says why there is no package of that name."""
        marker = next((path for hidden, path in self.hidden if hidden == name), None)
        if marker is None:
            return f"the package {name} is not in the workspace"
        return f"the package {name} is hidden by {marker.relative_to(self.root).as_posix()}"

    def package_of(self, path: Path) -> Package | None:
        """Return the innermost package that contains a file."""
        around = [one for one in self.packages if path.is_relative_to(one.folder)]
        return max(around, key=lambda one: len(one.folder.parts), default=None)

    def problems(self) -> Iterator[Problem]:
        """Yield everything that could not be read."""
        for one in self.packages:
            yield from one.problems
