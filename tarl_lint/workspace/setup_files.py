"""Read `setup.py` and `setup.cfg`: packages, their folders, console scripts. Nothing is executed."""

from __future__ import annotations

import configparser
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.python.interpreter import Interpreter

LARGEST: Final = 200_000  # maximum size of setup.cfg (bytes)
_CONSOLE: Final = re.compile(r"^\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*([\w.]+)\s*(?:\[.*\])?\s*$")
_SCANNED: Final = frozenset({"setuptools.find_packages", "setuptools.find_namespace_packages"})


@dataclass(frozen=True)
class Setup:
    """The contents of a package's setup files. `packages` is None if all packages below `folders[""]` are installed."""

    packages: tuple[str, ...] | None = ()
    modules: tuple[str, ...] = ()
    folders: Mapping[str, str] = field(default_factory=dict)
    scripts: tuple[str, ...] = ()
    console: tuple[tuple[str, str, str], ...] = ()  # (name, module, function) of each console script
    problems: tuple[Problem, ...] = ()


@dataclass(frozen=True)
class _Scan:
    """The result of `find_packages`."""

    where: str = "."


def setup(folder: Path) -> Setup:
    """Return what `setup.py` and `setup.cfg` in a folder declare; `setup.py` takes precedence."""
    problems: list[Problem] = []
    given: dict[str, Any] = {}
    if (folder / "setup.cfg").is_file():
        given |= _from_cfg(folder / "setup.cfg", problems)
    if (folder / "setup.py").is_file():
        given |= _from_py(folder / "setup.py", problems)
    return _setup(folder, given, problems)


def _from_py(path: Path, problems: list[Problem]) -> dict[str, Any]:
    """Return the keyword arguments of the call of `setup`."""
    calls: list[dict[str, Any]] = []

    def record(*_: Any, **keywords: Any) -> dict[str, Any]:
        calls.append(keywords)
        return keywords

    def scan(where: Any = ".", *_: Any, **__: Any) -> _Scan:
        return _Scan(where if isinstance(where, str) else ".")

    models: dict[str, Any] = dict.fromkeys(_SCANNED, scan)
    models |= dict.fromkeys(("setuptools.setup", "distutils.core.setup"), record)
    models["catkin_pkg.python_setup.generate_distutils_setup"] = lambda *_, **keywords: keywords
    file = Interpreter(path, models)
    file.run()
    problems += file.problems
    if not calls and not file.problems:
        problems.append(Problem(path, 0, "it has no call of setup that can be followed"))
    return {key: value for one in calls for key, value in one.items()}


def _from_cfg(path: Path, problems: list[Problem]) -> dict[str, Any]:
    """Return the contents of `setup.cfg` as arguments of `setup`."""
    parser = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(read_text(path, LARGEST))
    except UnreadableError as reason:
        problems.append(Problem(path, 0, str(reason)))
        return {}
    except configparser.Error as error:
        problems.append(Problem(path, 0, f"it cannot be read: {str(error).splitlines()[0]}"))
        return {}
    given: dict[str, Any] = {}
    for name in ("packages", "py_modules", "scripts"):
        lines = [
            line.strip() for line in parser.get("options", name, fallback="").splitlines() if line.strip()
        ]
        if lines and lines[0].startswith("find"):
            given[name] = _Scan(parser.get("options.packages.find", "where", fallback="."))
        elif lines:
            given[name] = lines
    pairs = (line.partition("=") for line in parser.get("options", "package_dir", fallback="").splitlines())
    folders = {left.strip(): right.strip() for left, equals, right in pairs if equals}
    console = parser.get("options.entry_points", "console_scripts", fallback="").splitlines()
    return (
        given
        | ({"package_dir": folders} if folders else {})
        | ({"entry_points": {"console_scripts": console}} if console else {})
    )


def _setup(folder: Path, given: Mapping[str, Any], problems: list[Problem]) -> Setup:
    path = folder / "setup.py"
    folders = given.get("package_dir")
    places = (
        {key: one for key, one in folders.items() if isinstance(one, str)}
        if isinstance(folders, dict)
        else {}
    )
    if isinstance(folders, Unknown | Library):
        problems.append(Problem(path, getattr(folders, "line", 0), "`package_dir` is not constant"))
    packages = given.get("packages", ())
    if isinstance(packages, _Scan):
        if packages.where != ".":
            places.setdefault("", packages.where)
        packages = None
    elif isinstance(packages, Unknown | Library):
        problems.append(Problem(path, getattr(packages, "line", 0), "`packages` is not constant"))
        packages = None
    return Setup(
        packages=None if packages is None else _texts(path, "packages", packages, problems),
        modules=_texts(path, "py_modules", given.get("py_modules", ()), problems),
        folders={key: one for key, one in places.items() if isinstance(key, str)},
        scripts=_texts(path, "scripts", given.get("scripts", ()), problems),
        console=tuple(_console(path, given.get("entry_points", {}), problems)),
        problems=tuple(problems),
    )


def _texts(path: Path, what: str, values: Any, problems: list[Problem]) -> tuple[str, ...]:
    if isinstance(values, str):
        values = values.split()
    if values is None or not isinstance(values, Sequence):
        if values is not None:
            problems.append(Problem(path, getattr(values, "line", 0), f"`{what}` is not constant"))
        return ()
    unknown = [one for one in values if not isinstance(one, str)]
    problems += [
        Problem(path, getattr(one, "line", 0), f"a part of `{what}` is not constant") for one in unknown
    ]
    return tuple(one for one in values if isinstance(one, str))


def _console(path: Path, entries: Any, problems: list[Problem]) -> list[tuple[str, str, str]]:
    if isinstance(entries, Unknown | Library):
        problems.append(Problem(path, getattr(entries, "line", 0), "`entry_points` is not constant"))
        return []
    if isinstance(entries, dict):
        lines = entries.get("console_scripts", ())
    else:  # the entry points are the text of an INI section
        lines = str(entries).partition("[console_scripts]")[2].partition("[")[0]
    found = []
    for line in (
        lines.splitlines() if isinstance(lines, str) else _texts(path, "console_scripts", lines, problems)
    ):
        match = _CONSOLE.match(line)
        if match is not None:
            found.append((match[1], match[2], match[3]))
        elif line.strip():
            problems.append(
                Problem(path, 0, f"the console script `{line.strip()[:60]}` is not `name = module:function`")
            )
    return found
