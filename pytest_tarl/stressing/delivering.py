"""Run a stress test, write its files below `.tarl`, and report the result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.extras import missing_sobol
from pytest_tarl.files import slug, unwritten
from pytest_tarl.stressing import json_result, kept, margins, page, words
from pytest_tarl.stressing.findings import Stress
from pytest_tarl.stressing.guarantee import guarantee
from pytest_tarl.stressing.map_figure import map_figure
from pytest_tarl.stressing.sobol_indices import affordable
from pytest_tarl.stressing.stress_run import Request, stress
from tarl_lint.files import write_atomically


@dataclass(frozen=True)
class Delivered:
    """The lines for the terminal, why the test fails (or an empty text), and whether Ctrl-C was pressed."""

    lines: tuple[str, ...]
    problem: str
    interrupted: bool
    found: Stress | None = None  # None if Ctrl-C was pressed before the first result


def deliver(request: Request, root: Path) -> Delivered:
    """Replay the drifts of earlier failures, run the stress test, and write its result and page.

    Raise RecordingError if the test itself is broken.
    """
    name = f"{slug(request.fixture.test)}-{slug(request.drift)}"
    memory = kept.Kept(root / ".tarl" / "stress" / "failing", f"{request.fixture.test}[{request.drift}]")
    try:
        before = _replayed(request, memory)
    except KeyboardInterrupt:
        return Delivered(
            (f"{request.fixture.test}[{request.drift}]: interrupted before any result.",), "", True
        )
    found = stress(request)
    told = (
        *words.lines(found),
        *before,
        *_without_salib(found),
        *(f"  {line}" for line in _written(found, root, name, memory)),
    )
    return Delivered(told, _problem(found), found.ended == "interrupted", found)


def deliver_repairs(found: Stress, root: Path) -> list[str]:
    """Write result and page again, with the repairs; return a line per file not written."""
    name = f"{slug(found.test)}-{slug(found.drift)}"
    jobs = _documents(found, root, name)
    failed = {path: problem for path, write in jobs.items() if (problem := _failure(write, path)) is not None}
    return [f"  {one} The result above stands." for one in unwritten(failed, root)]


def _documents(found: Stress, root: Path, name: str) -> dict[Path, Callable[[Path], None]]:
    """Return, for the result and for the page, a function that writes it to a path."""
    return {
        root / ".tarl" / "stress" / f"{name}.json": _as_text(json_result.text(found)),
        _page(root, name): _as_text(page.render(found)),
    }


def _page(root: Path, name: str) -> Path:
    return root / ".tarl" / "report" / f"{name}-stress.html"


def _as_text(content: str) -> Callable[[Path], None]:
    return lambda path: write_atomically(path, content.encode(), parents=True)


def _replayed(request: Request, memory: kept.Kept) -> tuple[str, ...]:
    space = request.designation.drifts[request.drift].value
    points = memory.read(space)
    given = guarantee(request.fixture, request.designation)
    lines: list[str] = []
    for one in kept.replayed(points, request.rollout, request.drift, request.options.seed, given):
        told = f"{words.of_point(space, one.point)} {'still fails' if one.fails else 'holds now'}"
        episodes = f"{one.passed} of {kept.EPISODES} episodes pass, and the mean loss is {one.loss:.3g}"
        lines.append(f"  {'kept' if not lines else '':10} {told}: {episodes}.")
    return tuple(lines)


def _without_salib(found: Stress) -> tuple[str, ...]:
    """Return the advice to install SALib, if that is the only reason why there are no Sobol indices."""
    left = found.budget - found.episodes if found.seconds is None else 0
    if found.ended not in ("", "budget") or not affordable(len(found.space.extents), left):
        return ()
    advice = missing_sobol("The table of variances")
    return () if advice is None else (f"  {'variance':10} {advice}",)


def _written(found: Stress, root: Path, name: str, memory: kept.Kept) -> list[str]:
    """Write the files; return a line per file not written, and a line with the page's path."""
    folder = root / ".tarl"
    report = _page(root, name)
    jobs = _documents(found, root, name)
    if found.ended in ("", "budget"):
        jobs[folder / "margins" / f"{name}.json"] = lambda path: write_atomically(
            path, margins.text(margins.margins(found)).encode(), parents=True
        )
    drawn = map_figure(found)
    if drawn:
        jobs[folder / "report" / f"{name}-stress-map.svg"] = lambda path: write_atomically(
            path, drawn.encode(), parents=True
        )
    # a run that ended early without a failure must not delete the failures of earlier runs
    if not found.ended or found.failures:
        jobs[memory.folder] = lambda _: memory.write(found.failures)
    failed = {path: problem for path, write in jobs.items() if (problem := _failure(write, path)) is not None}
    lines = [f"{one} The result above stands." for one in unwritten(failed, root)]
    if report in failed:  # the page on disk, if any, is from an earlier run
        return lines
    return [*lines, f"{'report':10} {report.relative_to(root).as_posix()}"]


def _failure(write: Callable[[Path], None], path: Path) -> OSError | None:
    try:
        write(path)
    except OSError as problem:
        return problem
    return None


def _problem(found: Stress) -> str:
    """Return why the test fails, or an empty text.

    The test fails if a direction breaks `must_hold`, or if the nominal world differs from the recorded one.
    """
    if found.ended == "nominal":
        return words.nominal_words()
    return " ".join(words.broken_promises(found))
