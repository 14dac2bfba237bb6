"""Read a workspace: every package below a folder, with its contents."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from tarl_lint.workspace.executables import build, installed, may_be_started
from tarl_lint.workspace.folders import folders
from tarl_lint.workspace.launch_lookup import ENDINGS, TEST, is_launch_name
from tarl_lint.workspace.manifests import Manifest, manifest, plugins
from tarl_lint.workspace.model import INTERFACES, Hidden, Package, Problem, Workspace
from tarl_lint.workspace.parameter_yaml import YAML


@dataclass
class _Found:
    """Collects the files of a package while folders are walked."""

    folder: Path
    declared: bool
    interfaces: list[Path] = field(default_factory=list)
    configurations: list[Path] = field(default_factory=list)
    launch_files: list[Path] = field(default_factory=list)
    parameter_files: list[Path] = field(default_factory=list)
    scripts: list[Path] = field(default_factory=list)
    others: list[Path] = field(default_factory=list)

    def take(self, path: Path) -> None:
        """Classify a file by its name."""
        above = path.parent.name
        if _has_ending(path) or (above == "launch" and _is_launch_file(path)):
            self.launch_files.append(path)
        elif path.suffix == ".cfg" and _mentions(path, b"dynamic_reconfigure"):
            self.configurations.append(path)
        elif path.suffix in YAML:
            self.parameter_files.append(path)
        elif path.suffix in ("", ".py") and may_be_started(path):
            self.scripts.append(path)
        elif above == "launch" and path.suffix in (".xml", ".py") and path.name != "__init__.py":
            self.others.append(path)


def read(root: Path, kept: frozenset[Path] = frozenset()) -> Workspace:
    """Return the description of the workspace below a folder. Nothing is executed or written.

    Packages below a marker such as COLCON_IGNORE are hidden, except if the marked folder contains one of the
    folders in `kept`.
    """
    markers: list[Path] = []
    unread: list[Problem] = []
    packages = _by_name(_packages(root.resolve(), kept, markers, unread), unread)
    hidden: dict[str, Hidden] = {}
    for marker in markers:  # `_packages` appends the markers below hidden folders to this list
        for package in _packages(marker.parent, kept, markers):
            if package.name not in packages:
                hidden.setdefault(package.name, Hidden(package, marker))
    return Workspace(
        root.resolve(),
        tuple(packages[name] for name in sorted(packages)),
        tuple(hidden[name] for name in sorted(hidden)),
        tuple(unread),
    )


def _by_name(found: list[Package], unread: list[Problem]) -> dict[str, Package]:
    """Return the packages by name: the first with a `package.xml`, or else the first folder of definitions.

    Further folders of definitions with that name add types that it lacks.
    """
    by_name: dict[str, Package] = {}
    for one in sorted(found, key=lambda one: not _is_declared(one)):
        first = by_name.setdefault(one.name, one)
        if first is not one and _is_declared(one):
            reason = (
                f"the package {one.name} in {first.folder.name} has the same name, and is read in its place"
            )
            unread.append(Problem(one.folder / "package.xml", 0, reason))
        elif first is not one and not _is_declared(one):
            known = {file.name for file in first.interfaces}
            more = tuple(file for file in one.interfaces if file.name not in known)
            by_name[one.name] = replace(first, interfaces=first.interfaces + more)
    return by_name


def _is_declared(package: Package) -> bool:
    return (package.folder / "package.xml").is_file()


def _packages(
    root: Path, kept: frozenset[Path], markers: list[Path], unread: list[Problem] | None = None
) -> list[Package]:
    """Return the packages below a folder in the order of their folders.

    Markers such as COLCON_IGNORE are added to `markers`, and folders that cannot be read to `unread`.
    """
    found: dict[Path, _Found] = {}
    for folder, files in folders(root, kept, markers, unread):
        if "package.xml" in files:
            found[folder] = _Found(folder, declared=True)
        owner = next((found[one] for one in (folder, *folder.parents) if one in found), None)
        if folder.name in INTERFACES:
            interfaces = [folder / name for name in files if name.endswith(f".{folder.name}")]
            if interfaces:
                found.setdefault(
                    folder.parent, _Found(folder.parent, declared=False)
                ).interfaces += interfaces
        elif owner is not None:
            for name in files:
                owner.take(folder / name)
    return [_package(one) for one in found.values()]


def _package(found: _Found) -> Package:
    problems: list[Problem] = []
    if found.declared:
        declared, problems = manifest(found.folder)
    else:  # outside packages, the folder's name is the package
        declared = Manifest(found.folder.name, "unknown")
    built = build(found.folder, declared)
    executables, modules, more = installed(found.folder, declared, found.scripts, built)
    nodelets, unread = plugins(found.folder, declared.plugins)
    configurations = (*found.configurations, *(found.folder / one for one in built.configurations))
    return Package(
        name=declared.name,
        folder=found.folder,
        kind=declared.kind,
        dependencies=declared.dependencies,
        executables=executables,
        modules=modules,
        interfaces=tuple(found.interfaces),
        configurations=tuple(dict.fromkeys(configurations)),
        launch_files=tuple(found.launch_files),
        parameter_files=tuple(found.parameter_files),
        problems=(*problems, *more, *unread),
        compiled=built.compiled,
        components=tuple(sorted({*built.components, *nodelets})),
        others=tuple(found.others),
        tests=built.tests,
    )


def _has_ending(path: Path) -> bool:
    """Return whether a file has the ending of a launch file; other programs use the ending of rostest, too."""
    return path.name.endswith(ENDINGS) and (path.suffix != TEST or _mentions(path, b"<launch"))


def _is_launch_file(path: Path) -> bool:
    """Return whether a file in a folder `launch` is a launch file despite an unusual ending."""
    if path.suffix == ".xml":
        return _mentions(path, b"<launch")
    if path.suffix in YAML:
        return is_launch_name(path.name) and _mentions(path, b"launch:")
    return path.suffix == ".py" and _mentions(path, b"def generate_launch_description(")


def _mentions(path: Path, word: bytes) -> bool:
    if not path.is_file():  # opening a named pipe would block
        return False
    try:
        with path.open("rb") as file:
            return word in file.read(200_000)
    except OSError:
        return False
