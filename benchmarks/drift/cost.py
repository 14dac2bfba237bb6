"""Measure the number of episodes that the search needs when a controller has more constants.

    python benchmarks/drift/cost.py [--seeds 2] [--sizes 10,20,40,80] [--workers 1]

Three tasks of the benchmark are padded with statements between sensor and command. The constants of these statements
have little effect (a correction of at most one in a thousand) or none (a limit that is never reached). The fault of the
node stays the same. The smallest size is the node without padding.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from math import log
from pathlib import Path
from statistics import fmean
from typing import Any

from ours import ours
from stage import HERE, Stage, visit

from tarl_lint.api import analyse

# task → file, the statement after which the padding is inserted, and the variable that the padding changes
PLACES = {
    "boat_in_current": ("boat.py", "course = -CROSS_GAIN * self.cross", "course"),
    "elbow_joint": ("elbow.py", "error = self.goal - angle", "error"),
    "pan_tracker": ("tracker.py", "pixels = msg.point.x - self.MIDDLE", "pixels"),
}
PADDING = ("{name} += 0.0004 * {name} / ({at}.7 + abs({name}))", "{name} = min({name}, 9{at}e4)")
A_BLOCK = 3  # number of constants in a block of padding


def padded(text: str, statement: str, name: str, blocks: int) -> str:
    """Return a node's text with blocks of padding after a statement."""
    before, found, after = text.partition(statement)
    assert found, statement
    indent = before.rpartition("\n")[2]
    lines = [line.format(name=name, at=at) for at in range(1, blocks + 1) for line in PADDING]
    return before + "\n".join([statement, *(indent + line for line in lines)]) + after


def counted(folder: Path) -> int:
    """Return the number of operands on the flows of a folder's nodes."""
    nodes = [path for path in folder.glob("*.py") if not path.name.startswith("test_")]
    analysis = analyse(nodes, root=folder)
    return len({o for step in analysis.sites for o in analysis.operands(step.site)})


def one(task: str, size: int, seed: int) -> dict[str, Any]:
    """Repair a task with about this number of operands."""
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent).resolve() / task
        shutil.copytree(HERE / task, folder, ignore=shutil.ignore_patterns("__pycache__"))
        file, statement, name = PLACES[task]
        blocks = max(0, round((size - counted(folder)) / A_BLOCK))
        node = folder / file
        node.write_text(padded(node.read_text(), statement, name, blocks))

        def look(stage: Stage) -> dict[str, Any]:
            found = ours(stage, seed)
            return {
                "operands": counted(folder),
                "search": found["episodes"]["search"],
                "restored": bool(found["drifted restored"] and found["nominal restored"]),
                "edits": found["edits"],
            }

        found: dict[str, Any] = visit(task, look, folder)
        return found


def main() -> None:
    """Print a row for each size, and how fast the number of episodes grows with the number of operands."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--sizes", default="10,20,40,80")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--one", nargs=3, metavar=("TASK", "SIZE", "SEED"), help="print one result as JSON")
    arguments = parser.parse_args()
    if arguments.one:
        task, size, seed = arguments.one
        print("\n" + json.dumps(one(task, int(size), int(seed)), ensure_ascii=False))
        return
    sizes = [int(size) for size in arguments.sizes.split(",")]
    jobs = [(task, size, seed) for size in sizes for seed in range(arguments.seeds) for task in PLACES]
    with ThreadPoolExecutor(arguments.workers) as pool:
        found = list(pool.map(_started, jobs))
    print("| operands, mean | search episodes, mean | by task | both worlds restored |\n|---|---|---|---|")
    points = []
    for size in sizes:
        seen = [(job[0], result) for job, result in zip(jobs, found, strict=True) if job[1] == size]
        many, spent = (fmean(result[what] for _, result in seen) for what in ("operands", "search"))
        points.append((many, spent))
        by_task = ", ".join(
            f"{task} {fmean(result['search'] for name, result in seen if name == task):.0f}"
            for task in PLACES
        )
        restored = sum(result["restored"] for _, result in seen)
        print(f"| {many:.0f} | {spent:.0f} | {by_task} | {restored}/{len(seen)} |")
    (least, cheap), (most, dear) = points[0], points[-1]
    print(f"\nepisodes grow as operands to the power of {log(dear / cheap) / log(most / least):.2f}")


def _started(job: tuple[str, int, int]) -> dict[str, Any]:
    command = [sys.executable, __file__, "--one", *map(str, job)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{job} failed:\n{done.stderr[-3000:]}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    print(*job, found, file=sys.stderr)
    return found


if __name__ == "__main__":
    main()
