"""Look whether the tasks are what the benchmark promises, without repairing anything.

    python benchmarks/drift/worlds.py [TASK ...] [--episodes 100]

Success off-line and under the drift, average total reward in both, time of an episode, number of sites and operands.
"""

from __future__ import annotations

import argparse
import time
from statistics import fmean
from typing import Any

from stage import TASKS, Stage, visit

from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.seeds import episode_seeds


def look(stage: Stage, episodes: int) -> dict[str, Any]:
    """Run one task's episodes in both worlds."""
    found: dict[str, Any] = {
        "sites": len(stage.analysis.sites),
        "operands": sum(len(stage.analysis.operands(step.site)) for step in stage.analysis.sites),
    }
    for name, drift in (("off-line", None), ("drift", stage.drift)):
        start = time.process_time()
        runs = [
            stage.rollout(EpisodePlan(seed, drift)) for seed in episode_seeds(7, f"look-{name}", episodes)
        ]
        found[f"ms {name}"] = (time.process_time() - start) / episodes * 1000
        found[f"passed {name}"] = fmean(run.passed for run in runs)
        found[f"ATR {name}"] = fmean(float(run.trace.reward.sum()) for run in runs)
        broken = next((run.broken for run in runs if run.broken), "")
        if broken:
            raise SystemExit(f"{stage.task}: {broken}")
        found[f"why {name}"] = next((run.failure for run in runs if run.failure), "")
    return found


def main() -> None:
    """Print a line per task."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*")
    parser.add_argument("--episodes", type=int, default=100)
    arguments = parser.parse_args()
    print("| task | sites | operands | ms off-line / drift | success | ATR |\n|---|---|---|---|---|---|")
    for task in arguments.tasks or TASKS:
        found = visit(task, lambda stage: look(stage, arguments.episodes))
        pairs = [
            " / ".join(f"{found[f'{what} {world}']:.{digits}f}" for world in ("off-line", "drift"))
            for what, digits in (("ms", 1), ("passed", 2), ("ATR", 2))
        ]
        print(f"| {task} | {found['sites']} | {found['operands']} | {' | '.join(pairs)} |", flush=True)


if __name__ == "__main__":
    main()
