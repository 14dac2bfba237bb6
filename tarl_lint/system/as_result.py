"""The findings of systems as the result of a run, for the formats that list findings one by one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from tarl_lint.baseline import Accepted
from tarl_lint.files import shown
from tarl_lint.model import Finding
from tarl_lint.read.discover import Notes
from tarl_lint.read.source import SourceError
from tarl_lint.run.runner import UNREADABLE, Result, Statistics, failing
from tarl_lint.settings.config import Config
from tarl_lint.system.hazards import ARCHITECTURE
from tarl_lint.system.model import System


def as_result(systems: Sequence[System], config: Config, vanished: tuple[Accepted, ...] = ()) -> Result:
    """Return the hazards of all systems, each once, and the files that could not be read.

    `vanished` are the entries of the baseline that are no longer found in the systems. Flows are not part of the
    result. Flows of a single program are findings of a run without launch files, and flows across nodes have no
    single place.
    """
    findings = _each_once(systems)
    files = {shown(one.file) for one in systems if not one.file.is_dir()}
    files |= {shown(each.node.file) for one in systems if not one.file.is_dir() for each in one.instances}
    files |= {each.interface.path for one in systems for each in one.instances if each.interface is not None}
    cut = {cut for one in systems for each in one.instances if each.interface for cut in each.interface.cut}
    return Result(
        findings=findings,
        silenced=tuple(dict.fromkeys(one for system in systems for one in system.silenced)),
        errors=errors(systems),
        vanished=vanished,
        statistics=Statistics(
            files=len(files), notes=Notes(unread_nodes=_unread(systems)), cut=tuple(sorted(cut))
        ),
        baseline=config.baseline if config.baseline and config.baseline.exists() else None,
        names_errors=config.enabled(UNREADABLE),
        left_out=len({finding for one in systems for finding in one.disabled}),
        kinds=(),
        reports_hazards=any(map(config.enabled, ARCHITECTURE)),
        failing=failing(findings, config),
    )


def errors(systems: Iterable[System]) -> tuple[SourceError, ...]:
    """Return the launch files and Python programs that cannot be read, each once, sorted."""
    return tuple(sorted(set(_errors(systems)), key=lambda one: (one.path, one.line, one.message)))


def _errors(systems: Iterable[System]) -> Iterator[SourceError]:
    for system in systems:
        for one in system.problems:
            if one.unreadable:
                yield SourceError(
                    shown(one.file), max(one.line, 1), f"The file cannot be read: {one.reason}."
                )
        yield from (each.broken for each in system.instances if each.broken is not None)


def _each_once(systems: Iterable[System]) -> tuple[Finding, ...]:
    """Return the findings of all systems, sorted. A finding is new if it is new in one of the systems."""
    found: dict[Finding, Finding] = {}
    for finding in (one for system in systems for one in system.findings):
        known = found.setdefault(replace(finding, status="new"), finding)
        if known.status == "accepted":
            found[replace(finding, status="new")] = finding
    return tuple(sorted(found.values(), key=lambda one: (one.span, one.code, one.message)))


def _unread(systems: Iterable[System]) -> int:
    """Return the number of places at which launch files start a node that was not read."""
    unread = {
        (one.node.file, one.node.line, one.name)
        for system in systems
        for one in system.instances
        if one.interface is None and one.broken is None and one.node.kind != "test"
    }
    return len(unread)
