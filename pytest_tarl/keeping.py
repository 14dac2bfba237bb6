"""Write the files of a comparison (result, sample, page), and report those that could not be written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.comparing import Online
from pytest_tarl.errors import TarlError
from pytest_tarl.files import unwritten
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.model import Comparison, Repair
from pytest_tarl.report import json_result


@dataclass(frozen=True)
class Kept:
    """The page's path if it was written, and lines about missing packages and files that were not written."""

    page: Path | None
    missing: tuple[str, ...]
    unwritten: tuple[str, ...]


def keep(comparison: Comparison, online: Online, episodes: Mapping[str, int], root: Path, name: str) -> Kept:
    """Write a comparison's files below `root`; write errors become lines, so that the verdict is not lost."""
    folder = root / ".tarl"
    result, recording, page = (
        folder / where / f"{name}{ending}"
        for where, ending in (("results", ".json"), ("online", ".npz"), ("report", ".html"))
    )

    def write_page() -> None:
        from pytest_tarl.report import html

        html.write(comparison, page)

    problems = {
        result: _problem(lambda: json_result.write(comparison, result, episodes)),
        recording: _problem(lambda: fixtures.save(as_fixture(comparison, online), recording)),
        page: _problem(write_page),
    }
    failed = {
        path: one.__cause__
        for path, one in problems.items()
        if one is not None and isinstance(one.__cause__, OSError)
    }
    missing = tuple(
        f"  no report page: {one}" for path, one in problems.items() if one and path not in failed
    )
    return Kept(
        None if problems[page] else page,
        missing,
        tuple(f"  {one} The verdict above stands." for one in unwritten(failed, root)),
    )


def _problem(write: Callable[[], None]) -> TarlError | None:
    try:
        write()
    except TarlError as problem:
        return problem
    return None


def by_hand(repair: Repair | None) -> list[str]:
    """Return the lines of an accepted patch that could not be written to a file; otherwise an empty list."""
    if repair is None or not repair.accepted or repair.patch:
        return []
    told = (
        "  The patch could not be written below .tarl/patches. Save the following lines to a file and run `tarl "
        "apply` on it:"
    )
    return [told, *repair.diff.splitlines()]


def as_fixture(comparison: Comparison, online: Online) -> Fixture:
    """Return the deployed world's sample in the format of a recording, for `tarl show`."""
    return Fixture(
        test=comparison.test,
        seed=comparison.seed,
        sensors=comparison.sensors,
        lists=tuple(one.taint_list for one in comparison.lists),
        topics=online.recorded.topics,
        sample=online.recorded.sample,
        sarsa=online.sarsa,
        learner=online.recorded.learner,
    )
