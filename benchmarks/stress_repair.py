"""Measure how far repairs at the boundary move it, on the tasks of benchmarks/drift.

    python benchmarks/stress_repair.py [TASK ...] [--results FILE]

Each task has one direction, from its nominal value to its drift. It is recorded, stressed with 246 episodes, repaired
at the boundary and beyond, and stressed again, as by `pytest --tarl-stress --tarl-repair` with seed 1. A line per task
gives the boundary's interval before and after the repair, as shares of the range, and the change. With `--results`,
results are stored in a JSON Lines file; tasks already in the file are not run again.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "drift")]

from drift_sizes import sized  # noqa: E402
from stage import TASKS, Stage, visit  # noqa: E402
from stress import EPISODES, GRID, SHARE, span_of  # noqa: E402

from pytest_tarl.boundary_repairs import Job, repair_boundary  # noqa: E402
from pytest_tarl.drifts import Drift  # noqa: E402
from pytest_tarl.learning.fixture import Fixture  # noqa: E402
from pytest_tarl.options import Options  # noqa: E402
from pytest_tarl.recording import mean_flows, run_episodes, sarsa_tables  # noqa: E402
from pytest_tarl.seeds import episode_seeds  # noqa: E402
from pytest_tarl.stressing.margins import Margin, margins  # noqa: E402
from pytest_tarl.stressing.stress_run import Request, stress  # noqa: E402

SEED = 1
BUDGET = round(SHARE * GRID * EPISODES)


@dataclass(frozen=True)
class Moved:
    """A task: the boundary's interval before and after, as shares of the range; the change; the report."""

    before: tuple[float | None, float | None]
    after: tuple[float | None, float | None]
    change: str
    report: Sequence[str]

    @property
    def grew(self) -> bool | None:
        """Return whether the guarantee now fails farther from nominal, or nowhere; None without a repair."""
        before, after = self.before[1], self.after[1]
        return None if not self.change else after is None or (before is not None and after > before)

    @property
    def line(self) -> str:
        """Return the table's columns except the task's name."""
        change = self.change or "no repair"
        return f"{shown(self.before)} | {shown(self.after) if self.change else ''} | {change}"


def shown(interval: tuple[float | None, float | None]) -> str:
    """Format an interval; an open upper end is shown as `end`."""
    low, high = interval
    return f"{low or 0.0:.3f}–{'end' if high is None else format(high, '.3f')}"


def job_of(stage: Stage) -> Job:
    """Record a task; return what stress and repair need."""
    name = stage.drift
    rollout, nominal, far = sized(stage, name)
    marked = replace(stage.marked, drifts={name: Drift(span_of(nominal, far))})
    recorded = run_episodes(
        stage.rollout, episode_seeds(SEED, "offline", marked.episodes), None, stage.sites.members, quiet
    )
    tables = sarsa_tables(recorded, mean_flows(recorded.sample))
    fixture = Fixture(
        stage.test, SEED, marked.sensors, stage.sites.lists, recorded.topics, recorded.sample, tables
    )
    options = Options(mode="stress", seed=SEED, stress_budget=BUDGET, stress_repair=True)
    request = Request(rollout, fixture, marked, options, name, quiet)

    changeable = {str(step.site) for step in stage.analysis.sites if stage.analysis.operands(step.site)}
    return Job(
        request,
        stage.analysis,
        stage.sites,
        stage.folder,
        stage.folder / ".tarl" / "patches",
        None,
        tuple,
        changeable,
    )


def moved(stage: Stage) -> Moved:
    """Stress and repair a task."""
    job = job_of(stage)
    found = stress(job.request, combined=False)
    told = repair_boundary(job, found)
    (before,) = margins(found).sides
    if told.patch is None or told.fixed is None:
        return Moved(interval(before), interval(before), "", told.lines)
    told.patch.unlink()
    (row,) = told.fixed.rows
    assert row.after is not None
    return Moved(interval(before), interval(row.after), row.change, told.lines)


def interval(side: Margin) -> tuple[float | None, float | None]:
    """Return both ends as shares of the range."""
    low, high = (None if one is None else side.share(one) for one in (side.holds_to, side.fails_at))
    return low, high


def quiet(done: int, total: int, what: str) -> None:
    """Show no progress."""


def main() -> None:
    """Print a line per task, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*")
    parser.add_argument("--results", type=Path, help="JSON Lines file of results to continue")
    arguments = parser.parse_args()
    path: Path | None = arguments.results
    lines = path.read_text().splitlines() if path is not None and path.exists() else []
    done = {task: Moved(**one) for task, one in map(json.loads, lines)}
    print("| task | before | after | boundary |\n|---|---|---|---|")
    for task in arguments.tasks or TASKS:
        if task not in done:
            done[task] = visit(task, moved)
            if path is not None:
                with path.open("a") as out:
                    out.write(f"{json.dumps([task, asdict(done[task])])}\n")
        print(f"| {task} | {done[task].line} |", flush=True)
    every = list(done.values())
    print(f"\nRepaired: {sum(bool(one.change) for one in every)} of {len(every)}.")
    print(
        f"The boundary moved away from nominal in {sum(bool(one.grew) for one in every)}, significantly in",
        end=" ",
    )
    print(f"{sum(one.change == 'more robust' for one in every)};", end=" ")
    print(f"it moved significantly nearer in {sum(one.change == 'more fragile' for one in every)}.")


if __name__ == "__main__":
    main()
