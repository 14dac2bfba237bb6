"""Analysis of all files of a run, group by group; results of an earlier run are reused."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from tarl_lint.prefilter.by_words import groups
from tarl_lint.read.source import TOO_DEEP, Module, Script, SourceError, parsed
from tarl_lint.read.watched import Reading
from tarl_lint.run.cache import Cache, Report, digest
from tarl_lint.run.gc_paused import without_collection
from tarl_lint.run.progress import Tell, silent
from tarl_lint.settings.config import Config

# minimum number of lines for which starting processes saves time
MANY_LINES: Final = 30_000


@dataclass(frozen=True)
class Task:
    """Files to be analysed together, or a single file that only needs to be parsed."""

    scripts: tuple[Script, ...]
    analyse: bool

    @property
    def lines(self) -> int:
        """Return the number of lines to analyse."""
        return sum(s.text.count("\n") for s in self.scripts) if self.analyse else 0


# called with the report so far and the final files
Partly = Callable[[Report, frozenset[str]], None]


def examine(
    scripts: Sequence[Script],
    config: Config,
    cache: Cache,
    jobs: int | None = 1,
    tell: Tell = silent,
    partly: Partly | None = None,
) -> Report:
    """Return the findings in the files. They do not depend on the number of processes (None: chosen by the size).

    If there are several analyses, `partly` gets the report so far after 1, 2, 4, … of them. With `partly`, programs
    that are run from an edited file come first, then small programs before large ones.
    """
    digests = {
        s.path: digest([s.path, s.name, str((s.is_package, s.installed)), *s.started, s.text])
        for s in scripts
    }
    whole = digest(digests.values())
    known = cache.plan(whole)
    if known:
        reports = [report for key in known if (report := cache.report(key)) is not None]
    else:
        tasks = _tasks(scripts, config)
        keys = [digest([str(task.analyse), *(digests[s.path] for s in task.scripts)]) for task in tasks]
        edited = cache.edited(digests)
        told = None if partly is None else _Progressive(partly, edited)
        reports = _reports(tasks, keys, config, cache, jobs, tell, told)
        cache.put_plan(whole, keys)
    cache.save()
    return _joined(reports)


def _joined(reports: Sequence[Report]) -> Report:
    """Return the reports of all programs as one."""
    errors = sorted({e for r in reports for e in r.errors}, key=lambda e: (e.path, e.line, e.message))
    # two programs that share a file have the same findings in it
    findings = tuple(dict.fromkeys(f for r in reports for f in r.findings))
    return Report(
        findings,
        tuple(errors),
        tuple(sorted({c for r in reports for c in r.cut})),
        _every(r.ended for r in reports),
    )


def _every(names: Iterable[Iterable[str]]) -> tuple[str, ...]:
    return tuple(sorted({name for some in names for name in some}))


def _tasks(scripts: Sequence[Script], config: Config) -> list[Task]:
    found = (group for group in groups(scripts, config) if not all(s.installed for s in group))
    grouped = [Task(group, analyse=True) for group in found]
    inside = {s.path for task in grouped for s in task.scripts}
    alone = (s for s in scripts if s.path not in inside and not s.installed)
    return [*grouped, *(Task((s,), analyse=False) for s in alone)]


@dataclass(frozen=True)
class _Progressive:
    """Reports the findings so far while other programs are still to be analysed."""

    partly: Partly
    edited: frozenset[str]

    def turn(self, task: Task) -> tuple[bool, int]:
        """Return the priority of a program: programs from an edited file first, then small programs."""
        return task.scripts[-1].path not in self.edited, task.lines

    def tell(self, tasks: Sequence[Task], found: Sequence[Report | None], done: int) -> None:
        """Report the findings so far. This happens only after 1, 2, 4, … analyses, since each report takes time."""
        pending = [task for task, report in zip(tasks, found, strict=True) if report is None]
        if not pending or done & (done - 1):
            return
        unsettled = {script.path for task in pending for script in task.scripts}
        settled = frozenset(s.path for task in tasks for s in task.scripts if s.path not in unsettled)
        self.partly(_joined([report for report in found if report is not None]), settled)


def _reports(
    tasks: Sequence[Task],
    keys: Sequence[str],
    config: Config,
    cache: Cache,
    jobs: int | None,
    tell: Tell,
    told: _Progressive | None,
) -> list[Report]:
    found = [_known(task, key, cache) for task, key in zip(tasks, keys, strict=True)]
    missing = [number for number, report in enumerate(found) if report is None]
    if told is not None:
        missing.sort(key=lambda number: told.turn(tasks[number]))
    work = [tasks[number] for number in missing]
    made = _made(work, config, _workers(work, jobs), tell, cache)
    for done, (number, report) in enumerate(zip(missing, made, strict=True), 1):
        found[number] = report
        cache.put(keys[number], report)
        if told is not None:
            told.tell(tasks, found, done)
    return [report for report in found if report is not None]


def _known(task: Task, key: str, cache: Cache) -> Report | None:
    """Return the report of a task if it is cached, or if a report for earlier texts of its files is still valid."""
    report = cache.report(key)
    if report is None and task.analyse:
        report = cache.adapted(task.scripts)
        if report is not None:
            cache.put(key, report)
    return report


def _workers(tasks: Sequence[Task], jobs: int | None) -> int:
    """Return the number of processes, limited by the number of groups and the size of the largest group."""
    wanted = sum(task.analyse for task in tasks)
    if jobs is None:
        lines = [task.lines for task in tasks]
        jobs = min(_processors(), sum(lines) // max(lines)) if sum(lines) >= MANY_LINES else 1
    return max(1, min(jobs, wanted))


def _processors() -> int:
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


def _made(tasks: Sequence[Task], config: Config, workers: int, tell: Tell, cache: Cache) -> Iterator[Report]:
    if workers > 1:
        from tarl_lint.run.workers import in_processes

        tell(f"Analysing in {workers} processes")
        sizes = [task.lines for task in tasks]
        reports = in_processes(partial(perform, config=config), tasks, sizes, workers, tell)
        if reports is not None:
            yield from reports
            return
    with without_collection():
        shared = _Parsed(tasks)
        for number, task in enumerate(tasks, 1):
            tell(f"Analysing {task.scripts[-1].path} ({number} of {len(tasks)})")
            readings: dict[str, Reading] | None = {} if cache.adapts and task.analyse else None
            report = perform(task, config, shared, readings)
            if readings is not None:
                cache.keep(task.scripts, readings, report)
            yield report


class _Parsed:
    """Parses files; a file that belongs to several tasks is parsed once."""

    def __init__(self, tasks: Sequence[Task] = ()) -> None:
        self._left = Counter(script.path for task in tasks for script in task.scripts)
        self._known: dict[str, Module | SourceError] = {}

    def module(self, script: Script) -> Module | SourceError:
        """Return the parsed file, or the reason why it cannot be parsed."""
        found = self._known.get(script.path) or _parsed(script)
        self._left[script.path] -= 1
        if self._left[script.path] > 0:
            self._known[script.path] = found
        else:
            self._known.pop(script.path, None)
        return found


def perform(
    task: Task,
    config: Config,
    shared: _Parsed | None = None,
    readings: dict[str, Reading] | None = None,
) -> Report:
    """Parse and analyse the files of a task. If the analysis crashes on a file, the file becomes an error entry.

    With `readings`, the parts that the analysis has read of each file are stored there.
    """
    with without_collection():
        parse = (shared or _Parsed()).module
        results = [parse(script) for script in task.scripts]
        errors = tuple(r for r in results if isinstance(r, SourceError))
        modules = [r for r in results if isinstance(r, Module)]
        if not task.analyse or not modules:
            return Report((), errors)
        from tarl_lint import engine  # slow to import, compared with checking a file

        findings, failures, cut, ended = engine.examine(
            modules, config, isolate=not debugging(), readings=readings
        )
    mistakes = (failure(path, error) for path, error in failures.items())
    return Report(findings, (*errors, *mistakes), cut, ended)


def _parsed(script: Script) -> Module | SourceError:
    try:
        return parsed(script)
    except Exception as error:
        if debugging():
            raise
        return failure(script.path, error)


def failure(path: str, error: Exception) -> SourceError:
    """Return the error entry of a file on which the analysis crashed."""
    if isinstance(error, RecursionError):
        return SourceError(path, 1, TOO_DEEP.format("analysed"))
    what = f"{type(error).__name__}: {error}".rstrip(": ")
    advice = "Please report it with the traceback from TARL_DEBUG=1; --exclude skips the file."
    return SourceError(
        path, 1, f"tarl-lint failed on this file ({what}), which is a bug in tarl-lint. {advice}", bug=True
    )


def debugging() -> bool:
    """Return whether to show tracebacks of internal errors."""
    return os.environ.get("TARL_DEBUG", "") not in ("", "0")
