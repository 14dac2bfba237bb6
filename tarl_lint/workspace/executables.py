"""Find the programs, by command name, and the top-level Python modules that a package installs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from tarl_lint.workspace.cmake import Cmake, cmake
from tarl_lint.workspace.manifests import Manifest
from tarl_lint.workspace.model import Executable, ImportRoot, Problem
from tarl_lint.workspace.setup_files import Setup, setup


def installed(
    folder: Path, manifest: Manifest, scripts: list[Path], built: Cmake
) -> tuple[tuple[Executable, ...], tuple[ImportRoot, ...], list[Problem]]:
    """Return the Python programs and modules of a package.

    `scripts` are its executable files with a Python shebang, and `built` is what its `CMakeLists.txt` installs.
    """
    declared = setup(folder)
    programs = {one.name: one for one in _programs(folder, declared, built)}
    # rosrun also starts files in the source folder that have the executable bit
    if manifest.kind == "catkin":
        programs |= {one.name: Executable(one.name, one) for one in scripts if one.name not in programs}
    modules = {one.name: one for one in _modules(folder, manifest, declared, built)}
    missing = [Problem(folder / "CMakeLists.txt" if not one.entry else folder / "setup.py", 0,
                       f"{one.name} is installed, but its file {one.module or one.name} does not exist")
               for one in programs.values() if one.path is None]  # fmt: skip
    problems = [*declared.problems, *built.problems, *missing]
    return (
        tuple(programs[name] for name in sorted(programs)),
        tuple(modules[name] for name in sorted(modules)),
        problems,
    )


def build(folder: Path, manifest: Manifest) -> Cmake:
    """Return what the `CMakeLists.txt` of a package builds; nothing for a package without CMake."""
    return Cmake() if manifest.kind == "ament_python" else cmake(folder, manifest.name)


def _programs(folder: Path, declared: Setup, built: Cmake) -> Iterator[Executable]:
    for name, module, function in declared.console:
        yield Executable(name, module_file(folder, declared, module), function, module)
    for script in declared.scripts:
        yield Executable(Path(script).name, _existing(folder / script))
    for file, name in built.programs:
        path = folder / file
        if not path.exists() and "${" not in file:
            yield Executable(name, None, module=file)
        elif path.is_file() and is_python(path):
            yield Executable(name, path)


def module_file(folder: Path, declared: Setup, module: str) -> Path | None:
    """Return the file of a module that a package installs; None if it does not exist."""
    first, *rest = module.split(".")
    base = _package_folder(folder, declared, first).joinpath(*rest)
    return _existing(base.with_suffix(".py")) or _existing(base / "__init__.py")


def _package_folder(folder: Path, declared: Setup, package: str) -> Path:
    """Return the folder of a top-level package according to `package_dir`."""
    if package in declared.folders:
        return folder / declared.folders[package]
    return folder / declared.folders.get("", "") / package


def _modules(folder: Path, manifest: Manifest, declared: Setup, built: Cmake) -> Iterator[ImportRoot]:
    if (folder / "setup.py").is_file() or (folder / "setup.cfg").is_file():
        if declared.packages is None:
            yield from _all_packages(folder / declared.folders.get("", ""))
        for name in {one.partition(".")[0] for one in declared.packages or ()}:
            place = _package_folder(folder, declared, name)
            if place.is_dir():
                yield ImportRoot(name, place)
        for name in declared.modules:
            place = folder / declared.folders.get("", "") / f"{name}.py"
            if place.is_file():
                yield ImportRoot(name, place)
    for name, place_text in built.python_packages:
        if (folder / place_text).is_dir():
            yield ImportRoot(name, folder / place_text)
    if manifest.kind == "unknown" and (folder / manifest.name / "__init__.py").is_file():
        yield ImportRoot(manifest.name, folder / manifest.name)


def _all_packages(folder: Path) -> Iterator[ImportRoot]:
    try:
        inside = sorted(folder.iterdir())
    except OSError:
        return
    for place in inside:
        if (place / "__init__.py").is_file() and place.name not in ("test", "tests"):
            yield ImportRoot(place.name, place)


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None


def is_python(path: Path) -> bool:
    """Return whether a file is Python, by its name or first line."""
    return path.suffix == ".py" or (not path.suffix and has_shebang(path))


def has_shebang(path: Path) -> bool:
    """Return whether a file's first line is a Python shebang."""
    if not path.is_file():  # opening a named pipe would block
        return False
    try:
        with path.open("rb") as file:
            first = file.read(120).split(b"\n", 1)[0]
    except OSError:
        return False
    return first.startswith(b"#!") and b"python" in first


def may_be_started(path: Path) -> bool:
    """Return whether `rosrun` can start a file in the source folder."""
    return os.access(path, os.X_OK) and has_shebang(path)
