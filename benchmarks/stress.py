"""Compare the boundaries found by stress runs with an exhaustive grid, and count false boundaries.

    python benchmarks/stress.py [TASK ...] [--harmless 25] [--grids FILE]

The tasks are those of benchmarks/drift and stress_examples.py. Each has one direction, from its nominal value to its
drift. The grid has 41 values, each with 40 episodes on its own seeds; its boundary is where the interpolated margin
first crosses zero. A line per task gives both boundaries as shares of the range, their distance, and the numbers of
episodes. With `--harmless N`, each task also gets N runs on the part of the range below half of the grid's boundary;
any boundary that these report is false. With `--grids`, the grids' boundaries are stored in a JSON Lines file; those
already in the file are not measured again.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "drift"), str(HERE)]

from drift_sizes import SIZE, Sized, sized  # noqa: E402
from stage import TASKS, Stage, visit  # noqa: E402
from stress_examples import EXAMPLES  # noqa: E402

from pytest_tarl.rollout import EpisodePlan  # noqa: E402
from pytest_tarl.seeds import episode_seeds  # noqa: E402
from pytest_tarl.spaces import Space, Span  # noqa: E402
from pytest_tarl.stressing.evaluating import BudgetSpentError, Evaluator  # noqa: E402
from pytest_tarl.stressing.findings import Curve  # noqa: E402
from pytest_tarl.stressing.guarantee import Guarantee, Outcome, guaranteed, outcome  # noqa: E402
from pytest_tarl.stressing.rays import rays  # noqa: E402
from pytest_tarl.stressing.stress_run import along_rays, near_ends  # noqa: E402

GRID, EPISODES = 41, 40  # number of values, and episodes per value
RECORDED = 100
SHARE = 0.15  # share of the grid's episodes that a stress run may use
NEAR = 0.05  # two boundaries agree if they are at most this share of the range apart
RISK = 0.05 / 3  # a run's alpha, divided among the tests of its ray, of combinations and of nominal


def span_of(low: float, high: float) -> Space:
    """Return the space from the nominal value to another value."""
    return Space({SIZE: Span(min(low, high), max(low, high), low)}, {})


def run_at(rollout: Sized, size: float, seeds: Sequence[int]) -> list[Outcome]:
    """Return the outcomes at a size."""
    return [outcome(rollout(EpisodePlan(seed, point={SIZE: size}))) for seed in seeds]


def recorded(rollout: Sized, nominal: float) -> Guarantee:
    """Return the guarantee from a recording of the nominal world."""
    runs = run_at(rollout, nominal, episode_seeds(11, "offline", RECORDED))
    stated = rollout.stage.marked.tolerance or 0.0
    tolerance = max(0.05 * abs(fmean(one.total for one in runs)), stated)
    return guaranteed(runs, tolerance, rollout.stage.marked)


def exhaustive(rollout: Sized, given: Guarantee, nominal: float, far: float) -> float | None:
    """Return where the margin first crosses zero, as a share of the range, or None if it never does."""
    seeds = episode_seeds(12, "grid", EPISODES)
    before = run_at(rollout, nominal, seeds)
    last = 1.0
    for number in range(1, GRID):
        after = run_at(rollout, nominal + (far - nominal) * number / (GRID - 1), seeds)
        loss = fmean(one.total - other.total for one, other in zip(before, after, strict=True))
        margin = given.margin(fmean(one.passed for one in after), loss)
        if margin < 0.0:
            return (number - 1 + last / (last - margin)) / (GRID - 1)
        last = margin
    return None


def stressed(rollout: Sized, given: Guarantee, space: Space, seed: int, budget: int) -> tuple[Curve, int]:
    """Return the curve of a stress run in one direction, and its number of episodes."""
    evaluator = Evaluator(rollout, space, "stress", given, seed, budget, lambda *_: None)
    (curve,) = (Curve(ray) for ray in rays(space, {}))
    with suppress(BudgetSpentError):
        along_rays([curve], evaluator, RISK)
        near_ends([curve], evaluator)
    return curve, evaluator.spent


@dataclass(frozen=True)
class Compared:
    """A task: boundaries as shares of the range, the run's episodes, and false boundaries in harmless runs."""

    grid: float | None
    found: float | None
    near: float | None
    far: float
    episodes: int
    harmless: int
    false: int

    @property
    def contains(self) -> bool:
        """Return whether the interval contains the grid's boundary.

        If the grid has no boundary, this means that the run finds none.
        """
        if self.grid is None or self.found is None:
            return self.grid is None and self.found is None
        return (self.near or 0.0) <= self.grid <= self.far

    @property
    def line(self) -> str:
        """Return the columns of the table, starting with the grid's boundary."""
        grid, found = (f"{one:.3f}" if one is not None else "none" for one in (self.grid, self.found))
        interval = "none" if self.found is None else f"{self.near or 0.0:.3f}–{self.far:.3f}"
        return (
            f"{grid} | {found} | {interval} | {'yes' if self.contains else 'no'} | {self.episodes} "
            f"| {100 * self.episodes / (GRID * EPISODES):.1f} % | {self.false} of {self.harmless}"
        )


@dataclass(frozen=True)
class Grids:
    """The grids' boundaries by task, stored in a JSON Lines file."""

    path: Path | None

    def boundary(self, task: str, measure: Callable[[], float | None]) -> float | None:
        """Return a task's boundary, measured if it is not in the file."""
        lines = self.path.read_text().splitlines() if self.path is not None and self.path.exists() else []
        known = dict(map(json.loads, lines))
        if task not in known:
            known[task] = measure()
            if self.path is not None:
                with self.path.open("a") as out:
                    out.write(f"{json.dumps([task, known[task]])}\n")
        found: float | None = known[task]
        return found


def compare(stage: Stage, harmless: int, grids: Grids) -> Compared:
    """Compare a stress run of a task with the grid."""
    example = EXAMPLES.get(stage.task)
    rollout, nominal, far = sized(stage, example.drift if example else stage.drift)
    given = recorded(rollout, nominal)
    budget = round(SHARE * GRID * EPISODES)
    curve, episodes = stressed(rollout, given, span_of(nominal, far), 1, budget)
    grid = grids.boundary(stage.task, lambda: exhaustive(rollout, given, nominal, far))
    found = curve.boundary
    false = 0
    if harmless:
        half = nominal + (far - nominal) * (0.5 * grid if grid is not None else 1.0)
        for seed in range(harmless):
            quiet, _ = stressed(rollout, given, span_of(nominal, half), 100 + seed, budget)
            false += quiet.confirmed is not None
    return Compared(
        grid,
        found.at if found else None,
        found.near if found else None,
        found.far if found else 1.0,
        episodes,
        harmless,
        false,
    )


def agrees(one: Compared) -> bool:
    """Return whether grid and stress run found boundaries near each other, or both found none."""
    if one.grid is None or one.found is None:
        return one.grid is None and one.found is None
    return abs(one.grid - one.found) <= NEAR


def main() -> None:
    """Print a line per task, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*")
    parser.add_argument(
        "--harmless",
        type=int,
        default=0,
        help="additional runs per task on a range where the guarantee holds",
    )
    parser.add_argument("--grids", type=Path, help="JSON Lines file of the grids' boundaries")
    arguments = parser.parse_args()
    print("| task | grid | stress | interval | contains | episodes | of the grid | false |")
    print("|---|---|---|---|---|---|---|---|")
    every, grids = [], Grids(arguments.grids)
    for task in arguments.tasks or (*TASKS, *EXAMPLES):
        example = EXAMPLES.get(task)
        one: Compared = visit(
            task,
            lambda stage: compare(stage, arguments.harmless, grids),
            example.place if example else None,
            HERE / "drift",
            example.test if example else "",
        )
        every.append(one)
        print(f"| {task} | {one.line} |", flush=True)
    near = sum(map(agrees, every))
    print(f"\nWithin {NEAR:.0%} of the range: {near} of {len(every)}.")
    print(
        f"Intervals that contain the grid's boundary: {sum(one.contains for one in every)} of {len(every)}."
    )
    print(f"False boundaries: {sum(one.false for one in every)} of {sum(one.harmless for one in every)}.")


if __name__ == "__main__":
    main()
