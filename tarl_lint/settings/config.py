"""Settings: `Options` (what the user typed) and `[tool.tarl-lint]` become a `Config`, valid for one run."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, cast

from tarl_lint.errors import ConfigError
from tarl_lint.files import shown
from tarl_lint.model import OFF_BY_DEFAULT
from tarl_lint.settings.schema import BASELINE_NAME, KEYS, FailOn, Wrapper

TABLE: Final = "tarl-lint"
_MENTIONS: Final = (TABLE.encode(), b"tool.tarl")  # matches also a table whose name is misspelt


@dataclass(frozen=True)
class Stdin:
    """The text of an unsaved file, read from standard input."""

    path: Path
    data: bytes


@dataclass(frozen=True)
class Options:
    """Command-line options. None means that the settings file or the default applies."""

    paths: tuple[Path, ...] = (Path(),)
    config: Path | None = None
    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] | None = None
    extend_select: tuple[str, ...] = ()
    exclude: tuple[str, ...] | None = None
    extend_exclude: tuple[str, ...] = ()
    baseline: Path | None = None
    no_baseline: bool = False
    write_baseline: bool = False
    fail_on: FailOn | None = None
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] | None = None
    stdin: Stdin | None = None
    cache: bool = True
    jobs: int | None = None  # number of processes; None means by the size of the run


@dataclass(frozen=True)
class Config:
    """Settings of one run. `Config()` is valid: every rule, nothing excluded, no baseline.

    `select`, `extend_select` and `ignore` contain rule codes or prefixes (`TARL1`); an empty `select` means all
    rules. A rule that is off by default is enabled only by its full code. `exclude` contains patterns as in
    .gitignore. These patterns and a named baseline are relative to `root`. `per_file_ignores` contains such
    patterns with the codes that are disabled in matching files. `sources`, `sinks` and `sanitizers` are qualified
    names (`robot.bus.listen`); results of sanitizers are not tainted. `wrappers` are functions that subscribe,
    publish or wait like a function of ROS. `remaps` are pairs of topic names: the name in the code, and the name at
    launch. With `tf2`, look-ups of transforms are also sources. With `clients`, requests to services and goals of
    actions are also sinks, and responses, results and feedback are also sources. With `arrivals`, whether a message
    has arrived also counts as a decision. `follow_installed` names packages in the virtual environment `python`
    that are also analysed. `origins` maps each key to its origin: "default", "command line" or the settings file.
    """

    root: Path | None = None
    select: tuple[str, ...] = ()
    extend_select: tuple[str, ...] = ()
    ignore: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    baseline: Path | None = None
    fail_on: FailOn = "explicit"
    sources: tuple[str, ...] = ()
    sinks: tuple[str, ...] = ()
    sanitizers: tuple[str, ...] = ()
    wrappers: tuple[Wrapper, ...] = ()
    remaps: tuple[tuple[str, str], ...] = ()
    tf2: bool = False
    clients: bool = False
    arrivals: bool = False
    follow_installed: tuple[str, ...] = ()
    python: str = ""
    per_file_ignores: tuple[tuple[str, tuple[str, ...]], ...] = ()
    file: Path | None = None
    origins: tuple[tuple[str, str], ...] = ()

    @cached_property
    def named(self) -> frozenset[str]:
        """Return the qualified names of the functions in the settings."""
        wrappers = (wrapper.name for wrapper in self.wrappers)
        return frozenset((*self.sources, *self.sinks, *self.sanitizers, *wrappers))

    @cached_property
    def launched(self) -> dict[str, str]:
        """Return a mapping: topic name in the code, without leading slash → topic name at launch."""
        return {old.lstrip("/"): new for old, new in self.remaps}

    def enabled(self, code: str) -> bool:
        """Return whether a rule is enabled."""
        if code.startswith(self.ignore):
            return False
        if code in OFF_BY_DEFAULT:
            return code in (*self.select, *self.extend_select)
        return not self.select or code.startswith((*self.select, *self.extend_select))


def resolve(options: Options) -> Config:
    """Find and read the settings file, override it with the command line, and return the settings of this run.

    Raises ConfigError for an unusable file, key or value. A named baseline need not exist.
    """
    start = common_directory(options.paths)
    file = options.config or find_settings(start)
    table = read_settings(file, required=options.config is not None) if file else {}
    root = file.resolve().parent if file else repository_root(start) or Path.cwd()
    origins: dict[str, str] = {}

    def choose(key: str, typed: Any, default: Any) -> Any:
        origin = "command line" if typed is not None else shown(file) if file and key in table else "default"
        origins[key] = origin
        return typed if typed is not None else table.get(key, default)

    def extended(key: str, added: tuple[str, ...], typed: Any = None) -> Any:
        """Return the value that `choose` returns, plus the values of an --extend option."""
        chosen = choose(key, typed, ())
        if added:
            before = origins[key]
            origins[key] = f"{before} and command line" if file and before == shown(file) else "command line"
        return (*chosen, *added)

    return Config(
        root=root,
        select=choose("select", options.select, ()),
        extend_select=extended("extend-select", options.extend_select),
        ignore=choose("ignore", options.ignore, ()),
        exclude=extended("exclude", options.extend_exclude, options.exclude),
        baseline=_baseline(options, root, choose("baseline", options.baseline, None)),
        fail_on=choose("fail-on", options.fail_on, "explicit"),
        sources=choose("sources", None, ()),
        sinks=choose("sinks", None, ()),
        sanitizers=choose("sanitizers", None, ()),
        wrappers=choose("wrappers", None, ()),
        remaps=choose("remaps", None, ()),
        tf2=choose("tf2", None, False),
        clients=choose("clients", None, False),
        arrivals=choose("arrivals", None, False),
        follow_installed=choose("follow-installed", None, ()),
        python=choose("python", None, ""),
        per_file_ignores=choose("per-file-ignores", options.per_file_ignores, ()),
        file=file,
        origins=tuple(origins.items()),
    )


def describing(paths: Sequence[Path], root: Path | None) -> Config:
    """Return those settings that describe the code at the paths, for a program that uses the analysis.

    These are sources, sinks, sanitizers, wrappers, `tf2` and `clients`. Settings for reports are left out. `tf2`
    and `clients` are on unless the settings file turns them off. The reason is that a program that runs the code
    can observe how the look-up of a transform depends on messages, and that a goal or a request moves a robot as a
    message does. Raises ConfigError.
    """
    file = find_settings(common_directory(paths))
    table = read_settings(file, required=False) if file else {}
    return Config(
        root=root,
        sources=table.get("sources", ()),
        sinks=table.get("sinks", ()),
        sanitizers=table.get("sanitizers", ()),
        wrappers=table.get("wrappers", ()),
        tf2=table.get("tf2", True),
        clients=table.get("clients", True),
    )


def _baseline(options: Options, root: Path, named: Path | str | None) -> Path | None:
    """Return the baseline file to use, or None if there is none or it is disabled."""
    if options.no_baseline:
        return None
    path = named if isinstance(named, Path) else root / (named or BASELINE_NAME)
    if (
        isinstance(named, str) and path.exists() and not path.is_file()
    ):  # a foreign repository may contain a named pipe, which would block
        raise ConfigError(f"The baseline {shown(path)} of the settings is not a regular file: name another.")
    return path if named is not None or options.write_baseline or path.is_file() else None


def common_directory(paths: Sequence[Path]) -> Path:
    """Return the deepest common directory of the paths, absolute; the working directory if there are none."""
    places = [os.path.abspath(p) for p in paths] or [os.getcwd()]  # noqa: PTH100, PTH109 - also for missing files
    try:
        common = Path(os.path.commonpath(places))
    except ValueError:  # raised if the paths are on different drives (Windows)
        return Path.cwd()
    return common if common.is_dir() else common.parent


def repository_root(start: Path) -> Path | None:
    """Return the nearest directory at or above `start` that is the top of a git work tree."""
    return next((d for d in (start, *start.parents) if (d / ".git").exists()), None)


def find_settings(start: Path) -> Path | None:
    """Return the nearest pyproject.toml with the table, from `start` up to the top of the repository."""
    top = repository_root(start)
    for directory in (start, *start.parents):
        candidate = directory / "pyproject.toml"
        if _mentions_us(candidate):
            return candidate
        if directory == top:
            return None
    return None


def _mentions_us(path: Path) -> bool:
    """Return whether the bytes mention the table.

    Most files do not mention the table, so they need no TOML parser, which is slow to import.
    """
    if not path.is_file():  # opening a named pipe would block
        return False
    try:
        data = path.read_bytes()
    except OSError:
        return False
    return any(mention in data for mention in _MENTIONS) and _table(path, data) is not None


def read_settings(path: Path, *, required: bool) -> Mapping[str, Any]:
    """Return the checked values of `[tool.tarl-lint]`, or of the top level of a separate settings file.

    Raises ConfigError for an unusable file, key or value.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"The settings file {shown(path)} cannot be read: {error.strerror}.") from None
    table = _table(path, data)
    if table is None and required:
        raise ConfigError(f"{shown(path)} has no [tool.{TABLE}] table: add one, or omit --config.")
    return {key: _check(path, key, value) for key, value in (table or {}).items()}


def _table(path: Path, data: bytes) -> dict[str, Any] | None:
    """Parse TOML and return the table; None if there is none. Raises ConfigError for invalid TOML."""
    document = _parse_toml(path, data)
    tool = document.get("tool")
    if isinstance(tool, dict) and TABLE in tool:
        table = tool[TABLE]
        if not isinstance(table, dict):
            raise ConfigError(
                f"{shown(path)}: tool.{TABLE} must be a table: write [tool.{TABLE}] on a line of its own."
            )
        return cast("dict[str, Any]", table)
    if path.name != "pyproject.toml":
        return document
    for name in tool if isinstance(tool, dict) else ():
        if name.replace("_", "-") == TABLE or suggestion(name, [TABLE], 0.85) != ".":
            raise ConfigError(f"{shown(path)}: there is no [tool.{name}]: did you mean [tool.{TABLE}]?")
    return None


def _parse_toml(path: Path, data: bytes) -> dict[str, Any]:
    toml = importlib.import_module("tomllib" if sys.version_info >= (3, 11) else "tomli")
    try:
        return cast("dict[str, Any]", toml.loads(data.decode("utf-8-sig")))
    except ValueError as error:  # this exception is also raised for bytes that are not UTF-8
        raise ConfigError(f"{shown(path)} is not valid TOML: {error}.") from None


def _check(path: Path, key: str, value: Any) -> Any:
    """Return a value in the form of `Config`. Raises ConfigError, which names the key or suggests another one."""
    if key not in KEYS:
        meant = suggestion(key.replace("_", "-"), KEYS)
        raise ConfigError(
            f"{shown(path)}: [tool.{TABLE}] has no key {key!r}{meant} Keys are {', '.join(KEYS)}."
        )
    convert, wanted = KEYS[key]
    try:
        checked = convert(value)
    except ValueError as error:
        raise ConfigError(f"{shown(path)}: {key!r} in [tool.{TABLE}]: {error}") from None
    if checked is None:
        raise ConfigError(f"{shown(path)}: {key!r} in [tool.{TABLE}] must be {wanted}, not {value!r}.")
    return checked


def suggestion(word: str, known: Mapping[str, Any] | Sequence[str], cutoff: float = 0.72) -> str:
    """Return ": did you mean 'x'?" if a known word is similar, else a full stop."""
    import difflib  # imported only after a mistake

    # compare without the prefix "--", which would make all options similar
    bare = {name.lstrip("-"): name for name in known}
    close = difflib.get_close_matches(word.lstrip("-"), list(bare), n=1, cutoff=cutoff)
    return f": did you mean {bare[close[0]]!r}?" if close else "."
