"""`tarl-lint --launch`: read launch files, analyse the programs that they start, and report the systems."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from tarl_lint import baseline
from tarl_lint.baseline import Accepted, Baseline
from tarl_lint.errors import UsageError
from tarl_lint.files import shown
from tarl_lint.fingerprints import OfHazard
from tarl_lint.model import Finding
from tarl_lint.prefilter.by_words import reached
from tarl_lint.read import discover
from tarl_lint.read.discover import SourceFile
from tarl_lint.read.source import Script
from tarl_lint.report.line import Line, View, unbroken
from tarl_lint.run import runner
from tarl_lint.run.cache import Cache, opened
from tarl_lint.run.progress import Tell, silent
from tarl_lint.settings.config import Config
from tarl_lint.settings.schema import BASELINE_NAME
from tarl_lint.system import compose
from tarl_lint.system.hazards import hazards
from tarl_lint.system.interface_cache import SPARE, keep, kept, key
from tarl_lint.system.interfaces import interface
from tarl_lint.system.model import Interface, System
from tarl_lint.workspace.folders import workspace_root
from tarl_lint.workspace.hidden_packages import folders_with, named_by
from tarl_lint.workspace.launch_lookup import NoLaunchFileError, launch_file, unknown_argument
from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.node_programs import Program
from tarl_lint.workspace.read import read

ALL: Final = "all"
FORMATS: Final = ("text", "json", "mermaid", "svg")


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
        """Return the folder of the workspace: the given path, or else that of the launch file or the current one."""
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
        self.launches = tuple(_launches(asked, self.workspace))
        hidden = {one for launch in self.launches for one in named_by(launch, self.workspace)}
        found = discover.find((root, *folders_with(hidden, self.workspace)), config)
        self.files: dict[Path, SourceFile] = {one.path.resolve(): one for one in found.files}
        self._known: dict[tuple[Program, str], Interface | str] = {}

    @cached_property
    def scripts(self) -> Mapping[str, Script]:
        """Return the files by displayed path."""
        found, _ = runner.read(tuple(self.files.values()), tell=self.tell)
        return {one.path: one for one in found}

    def interface(self, program: Program, fixed: Mapping[str, object]) -> Interface | str:
        """Return the interface of a program with these values of parameters, or why it cannot be analysed."""
        known = program, repr(sorted(fixed.items(), key=lambda one: one[0]))
        if known not in self._known:
            self._known[known] = self._analysed(program, fixed)
        return self._known[known]

    def _analysed(self, program: Program, fixed: Mapping[str, object]) -> Interface | str:
        file = self.files.get(program.path.resolve())
        if file is None:
            return f"{shown(program.path)} is excluded, or not Python"
        script = self.scripts.get(file.shown)
        if script is None:
            return f"{file.shown} is not Python 3"
        owner = self.workspace.package_of(program.path)
        package = owner.name if owner is not None else ""
        imported = reached([script], [one for one in self.scripts.values() if one.path != script.path])
        name = key(script, program.entry, package, imported, fixed)
        found = kept(self.cache, name)
        if found is None:
            self.tell(f"Analysing {file.shown}")
            found = interface(script, program.entry, package, imported, self.config, fixed)
            keep(self.cache, name, found)
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


def _launches(asked: Request, workspace: Workspace) -> Iterator[Launch]:
    if asked.launch not in ("", ALL):
        given = dict(asked.arguments)
        launch = read_launch(_launch_file(asked.launch, workspace), workspace, given)
        problem = unknown_argument(launch, given)
        # if there are no nodes, the file could not be read, and its arguments are unknown
        if problem and launch.nodes:
            raise UsageError(problem)
        yield launch
        return
    files = [file for package in workspace.packages for file in package.launch_files]
    if asked.launch == ALL and not files:
        raise UsageError(f"{shown(workspace.root)}: there is no launch file in a package at or below it.")
    if asked.launch == ALL:
        for file in files:
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
    if not nodes:
        raise UsageError(f"{shown(workspace.root)}: no package at or below it has a Python node.")
    yield Launch(workspace.root, tuple(nodes))


def _launch_file(named: str, workspace: Workspace) -> Path:
    """Return a launch file by its path, by its name in the workspace, or as `package/name`.

    Raises UsageError if there is no such file, or if several packages have one.
    """
    if Path(named).is_file():
        return Path(named).resolve()
    try:
        return launch_file(named, workspace, shown(workspace.root))
    except NoLaunchFileError as problem:
        raise UsageError(str(problem)) from None


def rendered(form: str, found: Sequence[System], asked: Request, view: View) -> Iterator[Line]:
    """Yield the lines of a report in one of the `FORMATS`. Raises UsageError for other formats."""
    if form == "text":
        from tarl_lint.system import text

        yield from map(unbroken, text.report(found, view, asked.origin, asked.target))
    elif form == "json":
        from tarl_lint.report.indented import dumped
        from tarl_lint.system.json import document

        yield ((dumped(document(found, asked.origin, asked.target)), ""),)
    elif form == "mermaid":
        from tarl_lint.system import mermaid

        yield from (((line, ""),) for line in mermaid.report(found))
    elif form == "svg":
        from tarl_lint.system import svg

        yield from (((line, ""),) for line in svg.report(found))
    else:
        raise UsageError(f"--format {form} cannot show launch files: use one of {', '.join(FORMATS)}.")


def judged(found: Sequence[System], config: Config, *, writing: bool = False) -> tuple[System, ...]:
    """Return the systems with the hazards of the enabled rules; hazards in the baseline are marked as accepted.

    Raises BaselineError if the baseline does not exist, unless this run writes it.
    """
    path = config.baseline
    known = baseline.load(path).counts() if path and (path.exists() or not writing) else {}
    return tuple(replace(one, findings=baseline.subtract(hazards(one, config), known)) for one in found)


def new_hazards(found: Sequence[System]) -> tuple[Finding, ...]:
    """Return the hazards that are not in the baseline."""
    return tuple(one for system in found for one in system.findings if one.status == "new")


def accepted(found: Sequence[System], config: Config) -> tuple[Path, Baseline]:
    """Return the baseline with the hazards of these systems, and its file; all other entries are kept."""
    path = config.baseline or Path(BASELINE_NAME)
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
    news = {entry.fingerprint for entry in entries}
    return path, baseline.merged(entries, [entry for entry in kept if entry.fingerprint not in news])
