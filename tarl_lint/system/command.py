"""`tarl-lint --launch`: read launch files, analyse the programs that they start, and report the systems."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress as suppress_errors
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Final

from tarl_lint import baseline, suppress
from tarl_lint.baseline import Accepted, Baseline
from tarl_lint.errors import UsageError
from tarl_lint.files import shown
from tarl_lint.fingerprints import OfHazard
from tarl_lint.model import Finding
from tarl_lint.prefilter.by_words import reached
from tarl_lint.read import discover
from tarl_lint.read.discover import SourceFile
from tarl_lint.read.source import Script, SourceError
from tarl_lint.report import LINE_BY_LINE
from tarl_lint.report.line import Line, View, unbroken
from tarl_lint.run import runner
from tarl_lint.run.cache import Cache, opened
from tarl_lint.run.progress import Tell, silent
from tarl_lint.run.runner import Result
from tarl_lint.settings.config import Config
from tarl_lint.settings.per_file import FileIgnores
from tarl_lint.settings.schema import BASELINE_NAME
from tarl_lint.system import compose
from tarl_lint.system.as_result import errors
from tarl_lint.system.cpp_sources import compiled, named_topics
from tarl_lint.system.hazards import hazards
from tarl_lint.system.interface_cache import SPARE, keep, kept, key
from tarl_lint.system.interfaces import interface
from tarl_lint.system.model import Interface, System
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.folders import workspace_root
from tarl_lint.workspace.hidden_packages import folders_with, named_by
from tarl_lint.workspace.launch_lookup import NoLaunchFileError, launch_file, unknown_argument
from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.node_programs import Program
from tarl_lint.workspace.read import read

ALL: Final = "all"
LARGEST: Final = 2_000_000  # maximum size of a file whose comments are read (bytes)


@dataclass(frozen=True)
class Request:
    """A user's request: the arguments, and a launch file, `all`, or "" for all nodes without launch files."""

    launch: str = ""
    arguments: tuple[tuple[str, str], ...] = ()
    paths: tuple[Path, ...] = ()
    origin: str = ""
    target: str = ""

    @cached_property
    def root(self) -> Path:
        """Return the folder of the workspace: the given path, or the launch file's folder, or the current folder."""
        if self.paths:
            return self.paths[0]
        path = Path(self.launch)
        if self.launch in ("", ALL) or not path.is_file():
            return Path()
        return workspace_root(path.resolve()) or path.resolve().parent


def request(launch: str | None, paths: Sequence[Path], origin: str | None, target: str | None) -> Request:
    """Return the request of a command line; a path with `:=` is an argument of the launch file.

    Raises UsageError for arguments without a launch file, and for several paths.
    """
    pairs = [str(path).partition(":=") for path in paths if ":=" in str(path)]
    plain = tuple(path for path in paths if ":=" not in str(path))
    if pairs and (launch is None or launch == ALL):
        raise UsageError(f"{''.join(pairs[0])} is an argument of a launch file: name the file with --launch.")
    assigned = next((path for path in plain if "=" in str(path) and not path.exists()), None)
    if assigned is not None:
        raise UsageError(f"{assigned}: no such folder. Arguments of a launch file are written NAME:=VALUE.")
    if len(plain) > 1:
        raise UsageError(f"--launch takes one folder of a workspace, not {len(plain)} paths.")
    given = tuple((name, value) for name, _, value in pairs)
    return Request(launch or "", given, plain, origin or "", target or "")


class _Workbench:
    """Reads the files of a workspace once.

    Analyses each program at most once, or not at all if `cache` has its interface.
    """

    def __init__(self, asked: Request, config: Config, tell: Tell, cache: Cache) -> None:
        self.config, self.tell, self.cache = config, tell, cache
        tell("Looking for packages")
        root = asked.root.resolve()
        self.workspace = read(root)
        self.launches = tuple(_launches(asked, self.workspace, config))
        hidden = {one for launch in self.launches for one in named_by(launch, self.workspace)}
        found = discover.find((root, *folders_with(hidden, self.workspace)), config)
        self.files: dict[Path, SourceFile] = {one.path.resolve(): one for one in found.files}
        self._known: dict[tuple[Program, str], Interface | SourceError | str] = {}

    @cached_property
    def scripts(self) -> Mapping[str, Script]:
        """Return the files by displayed path."""
        return {one.path: one for one in self._read[0]}

    @cached_property
    def _unreadable(self) -> Mapping[str, SourceError]:
        return {one.path: one for one in self._read[1]}

    @cached_property
    def _read(self) -> tuple[tuple[Script, ...], tuple[SourceError, ...]]:
        return runner.read(tuple(self.files.values()), tell=self.tell)

    def interface(self, program: Program, fixed: Mapping[str, object]) -> Interface | SourceError | str:
        """Return the interface of a program with these values of parameters, or why the program cannot be analysed."""
        known = program, repr(sorted(fixed.items(), key=lambda one: one[0]))
        if known not in self._known:
            self._known[known] = self._analysed(program, fixed)
        return self._known[known]

    def _analysed(self, program: Program, fixed: Mapping[str, object]) -> Interface | SourceError | str:
        file = self.files.get(program.path.resolve())
        if file is None:
            return f"{shown(program.path)} is excluded, or not Python"
        script = self.scripts.get(file.shown)
        if script is None:
            return self._unreadable[file.shown]
        owner = self.workspace.package_of(program.path)
        package = owner.name if owner is not None else ""
        imported = reached([script], [one for one in self.scripts.values() if one.path != script.path])
        name = key(script, program.entry, package, imported, fixed)
        found = kept(self.cache, name)
        if found is None:
            self.tell(f"Analysing {file.shown}")
            made = interface(script, program.entry, package, imported, self.config, fixed)
            keep(self.cache, name, made)
            return made
        return found


def systems(
    asked: Request, config: Config, tell: Tell = silent, *, cached: bool = False
) -> tuple[System, ...]:
    """Return the requested systems, and keep the interfaces of programs if `cached`.

    Raises UsageError without a workspace or launch file.
    """
    if not asked.root.is_dir():
        raise UsageError(f"{asked.root}: no such folder. Name the folder of a workspace.")
    cache = opened([asked.root], config, "system-", SPARE) if cached else Cache(None)
    bench = _Workbench(asked, config, tell, cache)
    made = [
        compose.composed(launch, bench.workspace, tuple(bench.files), bench.interface)
        for launch in bench.launches
    ]
    cache.save()
    return tuple(replace(one, arguments=asked.arguments) for one in made)


def _launches(asked: Request, workspace: Workspace, config: Config) -> Iterator[Launch]:
    if asked.launch not in ("", ALL):
        given = dict(asked.arguments)
        launch = read_launch(_launch_file(asked.launch, workspace), workspace, given)
        broken = next((one for one in launch.problems if one.unreadable and one.file == launch.file), None)
        if broken is not None:
            place = f"{shown(broken.file)}:{broken.line}" if broken.line else shown(broken.file)
            raise UsageError(f"{place}: the launch file cannot be read: {broken.reason}.")
        problem = unknown_argument(launch, given)
        # without nodes, the file could not be read, so its arguments are unknown
        if problem and launch.nodes:
            raise UsageError(problem)
        yield launch
        return
    files = [file for package in workspace.packages for file in package.launch_files]
    if asked.launch == ALL and not files:
        raise UsageError(f"{shown(workspace.root)}: there is no launch file in a package at or below it.")
    if asked.launch == ALL:
        for file in files:
            if discover.excluded(file, config):
                continue
            launch = read_launch(file, workspace)
            if launch.nodes or launch.problems:
                yield launch
        return
    nodes = [
        LaunchedNode(package.name, one.name, "", "/", one.path, 1)
        for package in workspace.packages
        for one in package.executables
        if one.path is not None
    ]
    nodes += [
        LaunchedNode(package.name, name, "", "/", package.folder / "CMakeLists.txt", 1)
        for package in workspace.packages
        for name in compiled(package)
        if named_topics(package, name)
    ]
    if not nodes:
        raise UsageError(f"{shown(workspace.root)}: no package at or below it has a node.")
    yield Launch(workspace.root, tuple(nodes))


def _launch_file(named: str, workspace: Workspace) -> Path:
    """Return a launch file by its path, by its name in the workspace, or as `package/name`.

    Raises UsageError if there is no such file, or if several packages have such a file.
    """
    if Path(named).is_file():
        return Path(named).resolve()
    try:
        return launch_file(named, workspace, shown(workspace.root))
    except NoLaunchFileError as problem:
        raise UsageError(str(problem)) from None


def rendered(
    form: str, found: Sequence[System], asked: Request, view: View, result: Result
) -> Iterator[Line]:
    """Return the lines of a report in one of the formats of `tarl-lint`; `result` has the hazards of the systems."""
    lines = _rendered(form, found, asked, view, result)
    return map(unbroken, lines) if form in LINE_BY_LINE else lines


def _rendered(
    form: str, found: Sequence[System], asked: Request, view: View, result: Result
) -> Iterator[Line]:
    ends = asked.origin, asked.target
    if form in ("mermaid", "svg", "dot"):
        drawn: Callable[..., Iterator[str]] = import_module(f"tarl_lint.system.{form}").report
        return (((line, ""),) for line in drawn(found, *ends))
    if form == "text":
        from tarl_lint.system import text

        return text.report(found, result, view, *ends)
    if form in ("concise", "github"):
        from tarl_lint.system import concise

        return (concise.concise if form == "concise" else concise.github)(found, result, view, *ends)
    if form == "json":
        from tarl_lint.report.indented import dumped
        from tarl_lint.system.json import document

        return iter([((dumped(document(found, *ends)), ""),)])
    if form == "json2":
        from tarl_lint.system import json2

        return json2.report(found, *ends)
    if form == "gitlab":
        from tarl_lint.report import gitlab

        return gitlab.report(result, view)
    listed: Callable[..., Iterator[Line]] = import_module(f"tarl_lint.system.{form}").report  # sarif, junit
    return listed(found, result, *ends)


def judged(found: Sequence[System], config: Config, *, writing: bool = False) -> tuple[System, ...]:
    """Return the systems with the hazards of the enabled rules; hazards in the baseline are marked as accepted.

    A hazard is left out if a comment or the setting `per-file-ignores` silences it.

    Raises BaselineError if the baseline does not exist, unless this run writes the baseline.
    """
    known = _baseline(config, writing=writing).counts()
    elsewhere = FileIgnores(config.root or Path.cwd(), config.per_file_ignores)
    return tuple(_judged(one, config, known, elsewhere) for one in found)


def _judged(system: System, config: Config, known: Mapping[str, int], elsewhere: FileIgnores) -> System:
    every = hazards(system, config)
    heard, silenced, _ = suppress.apply(every, _texts(every))
    disabled = tuple(one for one in heard if elsewhere.silences(one))
    findings = baseline.subtract([one for one in heard if one not in disabled], known)
    return replace(system, findings=findings, silenced=silenced, disabled=disabled)


def _texts(findings: Sequence[Finding]) -> Mapping[str, str]:
    """Return the texts of the files with findings, by displayed path; unreadable ones have no comments."""
    texts = {}
    for path in {one.span.path for one in findings}:
        with suppress_errors(UnreadableError):
            texts[path] = read_text(Path(path), LARGEST)
    return texts


def _baseline(config: Config, *, writing: bool) -> Baseline:
    path = config.baseline
    return baseline.load(path) if path and (path.exists() or not writing) else Baseline()


def vanished(found: Sequence[System], asked: Request, config: Config) -> tuple[Accepted, ...]:
    """Return the hazards in the baseline that no launch file has any more.

    Only a run of all launch files can know this, and only for those files of its workspace that it could read.
    """
    if asked.launch != ALL or config.baseline is None or not config.baseline.exists():
        return ()
    home, root = config.baseline.absolute().parent, os.path.realpath(asked.root)
    broken = {os.path.realpath(one.path) for one in errors(found)}

    def gone(entry: Accepted) -> bool:
        key = entry.fingerprint
        places = [os.path.realpath(home / name) for name in entry.files]
        inside = all(Path(one).is_relative_to(root) and one not in broken for one in places)
        return key.code.startswith(runner.ARCHITECTURE) and config.enabled(key.code) and inside

    counts: Counter[str] = Counter()
    for system in found:
        counts |= Counter(one.fingerprint for one in (*system.findings, *system.silenced, *system.disabled))
    return baseline.missing(baseline.load(config.baseline), counts, gone)[0]


def accepted(found: Sequence[System], config: Config, gone: Sequence[Accepted] = ()) -> tuple[Path, Baseline]:
    """Return the baseline with the hazards of these systems, and its file.

    All other entries are kept, except those in `gone`.
    """
    path = config.baseline or Path(BASELINE_NAME)
    removed = {one.fingerprint for one in gone}
    kept = baseline.load(path).entries if path.exists() else ()
    counts: dict[Finding, int] = {}
    for system in found:
        for finding, count in Counter(replace(one, status="new") for one in system.findings).items():
            counts[finding] = max(count, counts.get(finding, 0))
    home = path.absolute().parent
    entries = [
        Accepted(
            OfHazard(one.package, one.code, one.about, one.place),
            count,
            (Path(os.path.relpath(one.span.path, home)).as_posix(),),
        )
        for one, count in counts.items()
    ]
    news = {entry.fingerprint for entry in entries} | removed
    return path, baseline.merged(entries, [entry for entry in kept if entry.fingerprint not in news])
