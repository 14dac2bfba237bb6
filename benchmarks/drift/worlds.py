"""Check that the tasks have the properties stated for the benchmark, without repairing anything.

    python benchmarks/drift/worlds.py [TASK ...] [--episodes 100] [--folder benchmarks/drift] [--by-hand]

For each task, it prints the success rate and the average total reward, as designed and under the drift, the duration of
an episode, and the numbers of sites and operands. With `--by-hand`, it prints the same for a copy of each task with the
repair that the task's author knows: `answer.json` holds it under "hand", as triples of a file, a text in it, and the
replacement of that text.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import time
from pathlib import Path
from statistics import fmean
from typing import Any

from stage import HERE, Stage, answers_in, tasks_in, visit

from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.seeds import episode_seeds


def look(stage: Stage, episodes: int) -> dict[str, Any]:
    """Run one task's episodes in both worlds."""
    found: dict[str, Any] = {
        "sites": len(stage.analysis.sites),
        "operands": sum(len(stage.analysis.operands(step.site)) for step in stage.analysis.sites),
    }
    for name, drift in (("designed", None), ("drift", stage.drift)):
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


def seen(home: Path, task: str, episodes: int, by_hand: bool) -> dict[str, Any]:
    """Return the figures of one task, or of a copy of it that is repaired by hand."""
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch).resolve() / task
        shutil.copytree(home / task, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for name, old, new in answers_in(home)[task]["hand"] if by_hand else ():
            text = (copy / name).read_text()
            if text.count(old) != 1:
                raise SystemExit(f"{task}: {name} holds {text.count(old)} times {old!r}; it must occur once.")
            (copy / name).write_text(text.replace(old, new))
        found: dict[str, Any] = visit(task, lambda stage: look(stage, episodes), copy, home)
    return found


def main() -> None:
    """Print a line per task."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("tasks", nargs="*")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--folder", type=Path, default=HERE, help="folder of the tasks")
    parser.add_argument(
        "--by-hand", action="store_true", help="check copies of the tasks that are repaired by hand"
    )
    arguments = parser.parse_args()
    home = arguments.folder.resolve()
    print("| task | sites | operands | ms designed / drift | success | ATR |\n|---|---|---|---|---|---|")
    for task in arguments.tasks or tasks_in(home):
        found = seen(home, task, arguments.episodes, arguments.by_hand)
        pairs = [
            " / ".join(f"{found[f'{what} {world}']:.{digits}f}" for world in ("designed", "drift"))
            for what, digits in (("ms", 1), ("passed", 2), ("ATR", 2))
        ]
        print(f"| {task} | {found['sites']} | {found['operands']} | {' | '.join(pairs)} |", flush=True)


if __name__ == "__main__":
    main()
