"""Print the mean reward and the pass rate of a node in its designed world and under each drift.

    python benchmarks/real_nodes/bring.py TARGET --source PLACE
    python benchmarks/real_nodes/judge.py TARGET/wander [TARGET/NODE ...] [--episodes 400] [--seed 7] [--drift NAME]

Each folder was written by `bring.py`. Its node is unchanged, or has the repair by hand, or has a patch applied to it.
All worlds use the same held-out seeds, which neither recording, comparison nor repair uses.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import fmean

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "drift")]

from stage import Stage, visit  # noqa: E402

from pytest_tarl.rollout import EpisodePlan  # noqa: E402
from pytest_tarl.seeds import episode_seeds  # noqa: E402


def judged(stage: Stage, drifts: list[str], seed: int, episodes: int) -> list[str]:
    """Return a row for the designed world and for each drift. Raise SystemExit if an episode ends in an error."""
    rows = []
    seeds = episode_seeds(seed, "held out", episodes)
    for drift in [None, *(drifts or stage.marked.drifts)]:
        runs = [stage.rollout(EpisodePlan(one, drift)) for one in seeds]
        broken = next((run.broken for run in runs if run.broken), "")
        if broken:
            raise SystemExit(f"{stage.task}, {drift or 'designed'}: {broken}")
        total = fmean(float(run.trace.reward.sum()) for run in runs)
        failures = sorted({run.failure.splitlines()[0] for run in runs if run.failure})
        why = f" ({'; '.join(failures)[:100]})" if failures else ""
        passed = sum(run.passed for run in runs)
        rows.append(f"| {stage.task} | {drift or 'designed'} | {total:.2f} | {passed} of {episodes}{why} |")
    return rows


def main() -> None:
    """Print a row per world of each folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--episodes", type=int, default=400, help="episodes of each world")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--drift", action="append", default=[], help="only this drift; repeatable")
    arguments = parser.parse_args()
    print("| node | world | mean reward | passed |\n|---|---|---|---|")
    for folder in arguments.folders:
        place = folder.resolve()
        rows: list[str] = visit(
            place.name,
            lambda stage: judged(stage, arguments.drift, arguments.seed, arguments.episodes),
            place,
        )
        print("\n".join(rows), flush=True)


if __name__ == "__main__":
    main()
