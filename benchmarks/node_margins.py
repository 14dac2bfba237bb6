"""Print how far each real node's world may change before its guarantee fails, according to a stress run.

    python benchmarks/real_nodes/bring.py TARGET --source PLACE
    python benchmarks/node_margins.py TARGET [NODE ...]

Each drift of a world is a separate direction, from the nominal value to the drift's value. For a drift with several
numbers, the coordinate is the share of the way to these numbers. Each run has seed 1 and may use 600 episodes. Two
drifts that differ only in being permanent are one direction.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "drift")]

from drift_sizes import SIZE, Sized, sized  # noqa: E402
from stage import Stage, visit  # noqa: E402
from stress import RISK, recorded, span_of  # noqa: E402

from pytest_tarl.spaces import Space  # noqa: E402
from pytest_tarl.stressing import words  # noqa: E402
from pytest_tarl.stressing.evaluating import BudgetSpentError, Evaluator  # noqa: E402
from pytest_tarl.stressing.findings import Curve, Stress  # noqa: E402
from pytest_tarl.stressing.guarantee import Guarantee  # noqa: E402
from pytest_tarl.stressing.rays import rays  # noqa: E402
from pytest_tarl.stressing.stress_run import along_rays, near_ends  # noqa: E402

BUDGET, SEED = 600, 1


def margins(stage: Stage) -> list[Stress]:
    """Return a stress run for each of a node's drifts, from its nominal world to the drift."""
    distinct: dict[str, str] = {}  # value of a drift → first name with this value
    for name, drift in stage.marked.drifts.items():
        distinct.setdefault(repr(drift.value), name)
    given: Guarantee | None = None
    found = []
    for name in distinct.values():
        rollout, nominal, far = sized(stage, name)
        given = given or recorded(rollout, nominal)
        found.append(margin(rollout, name, span_of(nominal, far), given))
    return found


def margin(rollout: Sized, name: str, space: Space, given: Guarantee) -> Stress:
    """Return a stress run in one direction."""
    evaluator = Evaluator(rollout, space, name, given, SEED, BUDGET, lambda *_: None)
    curves = [Curve(ray) for ray in rays(space, {})]
    ended = ""
    try:
        along_rays(curves, evaluator, RISK)
        near_ends(curves, evaluator)
    except BudgetSpentError:
        ended = "budget"
    task = rollout.stage.task
    return Stress(task, name, SEED, space, given, BUDGET, evaluator.spent, tuple(curves), ended=ended)


def direction(found: Stress) -> str:
    """Return the name of a run's direction."""
    return found.drift.replace(" ", "_")


def main() -> None:
    """Print the report of each node."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("target", type=Path, help="the folder that bring.py filled")
    parser.add_argument("nodes", nargs="*")
    arguments = parser.parse_args()
    every = sorted(path.name for path in arguments.target.iterdir() if path.is_dir())
    for node in arguments.nodes or every:
        runs: list[Stress] = visit(node, margins, (arguments.target / node).resolve())
        for found in runs:
            lines = [line.replace(SIZE, direction(found)) for line in words.lines(found)]
            print("\n".join(lines), flush=True)


if __name__ == "__main__":
    main()
