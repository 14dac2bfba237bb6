"""Print how much the world of each real node may change before its guarantee fails, as a stress run reports it.

    python benchmarks/real_nodes/bring.py TARGET --source PLACE
    python benchmarks/node_margins.py TARGET [NODE ...]

Each world has a single direction, from its nominal value to its drift. The run may use 600 episodes, seed 1.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "drift")]

from stage import Stage, visit  # noqa: E402
from stress import RISK, SIZE, recorded, sized, span_of  # noqa: E402

from pytest_tarl.stressing import words  # noqa: E402
from pytest_tarl.stressing.evaluating import BudgetSpentError, Evaluator  # noqa: E402
from pytest_tarl.stressing.findings import Curve, Stress  # noqa: E402
from pytest_tarl.stressing.rays import rays  # noqa: E402
from pytest_tarl.stressing.search import along_rays, near_ends  # noqa: E402

BUDGET, SEED = 600, 1


def margins(stage: Stage) -> Stress:
    """Return the stress run of a node from its nominal world to its drift."""
    name = next(iter(stage.marked.drifts))
    rollout, nominal, far = sized(stage, name)
    space = span_of(nominal, far)
    given = recorded(rollout, nominal)
    evaluator = Evaluator(rollout, space, name, given, SEED, BUDGET, lambda *_: None)
    curves = [Curve(ray) for ray in rays(space, {})]
    ended = ""
    try:
        along_rays(curves, evaluator, RISK)
        near_ends(curves, evaluator)
    except BudgetSpentError:
        ended = "budget"
    return Stress(stage.task, name, SEED, space, given, BUDGET, evaluator.spent, tuple(curves), ended=ended)


def main() -> None:
    """Print the report of each node."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("target", type=Path, help="the folder that bring.py filled")
    parser.add_argument("nodes", nargs="*")
    arguments = parser.parse_args()
    every = sorted(path.name for path in arguments.target.iterdir() if path.is_dir())
    for node in arguments.nodes or every:
        found: Stress = visit(node, margins, (arguments.target / node).resolve())
        name = found.drift.replace(" ", "_")
        print("\n".join(line.replace(SIZE, name) for line in words.lines(found)), flush=True)


if __name__ == "__main__":
    main()
