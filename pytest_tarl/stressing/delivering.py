"""Run a stress test, write its files below `.tarl`, and report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.files import advice_on, slug, write_atomically
from pytest_tarl.stressing import json_result, kept, page, words
from pytest_tarl.stressing.findings import Stress
from pytest_tarl.stressing.guarantee import guarantee
from pytest_tarl.stressing.search import Request, stress


@dataclass(frozen=True)
class Delivered:
    """The lines of the terminal, why the test fails, and whether Ctrl-C ended the run."""

    lines: tuple[str, ...]
    problem: str
    interrupted: bool


def deliver(request: Request, root: Path) -> Delivered:
    """Replay kept drifts, stress, write result and page. Raise RecordingError if the test itself is broken."""
    name = f"{slug(request.fixture.test)}-{slug(request.drift)}"
    memory = root / ".tarl" / "stress" / f"{name}-failing.json"
    try:
        before = _replayed(request, memory)
    except KeyboardInterrupt:
        return Delivered(
            (f"{request.fixture.test}[{request.drift}]: interrupted, nothing is known.",), "", True
        )
    found = stress(request)
    unwritten = _written(found, root, name, memory)
    told = (*words.lines(found), *before, *(f"  {line}" for line in unwritten))
    return Delivered(told, _problem(found), found.ended == "interrupted")


def _replayed(request: Request, memory: Path) -> tuple[str, ...]:
    space = request.designation.drifts[request.drift].value
    points = kept.read(memory, space)
    given = guarantee(request.fixture, request.designation)
    lines: list[str] = []
    for point, fails in kept.replayed(points, request.rollout, request.drift, request.options.seed, given):
        where = words.of_point(space, point)
        lines.append(f"  {'kept' if not lines else '':10} {where} {'still fails' if fails else 'holds now'}.")
    return tuple(lines)


def _written(found: Stress, root: Path, name: str, memory: Path) -> list[str]:
    """Write the files; return a line for each that could not be written. The result does not depend on them."""
    folder = root / ".tarl"
    report = folder / "report" / f"{name}-stress.html"

    def as_text(content: str) -> Callable[[Path], None]:
        return lambda path: write_atomically(path, content.encode())

    jobs = {
        folder / "stress" / f"{name}.json": as_text(json_result.text(found)),
        report: as_text(page.render(found)),
    }
    if not found.ended or found.failures:  # an incomplete run without a failure keeps the earlier findings
        jobs[memory] = lambda path: kept.write(found.failures, path)
    lines = [line for path, write in jobs.items() for line in _unwritten(path, write, root)]
    return [*lines, f"{'report':10} {report.relative_to(root).as_posix()}"] if report.exists() else lines


def _unwritten(path: Path, write: Callable[[Path], None], root: Path) -> list[str]:
    try:
        write(path)
    except OSError as problem:
        why = problem.strerror or str(problem)
        return [f"not written: {path.relative_to(root).as_posix()} ({why}): {advice_on(problem)}"]
    return []


def _problem(found: Stress) -> str:
    """Return why the test fails: a broken `must_hold`, or a nominal world other than the recorded one; else empty."""
    if found.ended == "nominal":
        return words.nominal_words()
    return " ".join(words.broken_promises(found))
