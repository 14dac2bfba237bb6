"""Run the benchmark: every method on every task with every seed, side by side, and print the tables.

    python benchmarks/drift/run.py [--seeds 10] [--methods ours,random,…] [--tasks TASK,…] [--workers 2]

Results are kept in `results.json` beside this file, one entry per method, task and seed: what is there is not run
again (`--fresh` forgets the methods and tasks that are asked for), so that a run can be interrupted and carried on.
`--table` prints the tables from what is there. CMA-ES and Optuna need `pip install cma optuna`.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from stage import HERE, TASKS, visit
from table import tables

METHODS = (
    "ours",
    "random",
    "random, our guard",
    "CMA-ES",
    "CMA-ES, our guard",
    "Optuna",
    "Optuna, our guard",
)
RESULTS = HERE / "results.json"


def one(method: str, task: str, seed: int) -> dict[str, Any]:
    """Run one method on one task with one seed, on a copy of the task."""
    from ours import ours
    from peers import peer

    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve() / task
        shutil.copytree(HERE / task, copy, ignore=shutil.ignore_patterns("__pycache__"))
        if method == "ours":
            found: dict[str, Any] = visit(task, lambda stage: ours(stage, seed), copy)
        else:
            name, _, guard = method.partition(", ")
            found = visit(task, lambda stage: peer(stage, seed, name, bool(guard)), copy)
    return found


def main() -> None:
    """Run what is missing, each in a process of its own, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--methods", default=";".join(METHODS), help="separated by semicolons")
    parser.add_argument("--tasks", default=",".join(TASKS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--fresh", action="store_true", help="forget earlier results of what is asked for")
    parser.add_argument("--table", action="store_true", help="run nothing")
    parser.add_argument("--one", nargs=3, metavar=("METHOD", "TASK", "SEED"), help="print one result as JSON")
    arguments = parser.parse_args()
    if arguments.one:
        method, task, seed = arguments.one
        print("\n" + json.dumps(one(method, task, int(seed)), ensure_ascii=False))
        return
    methods, tasks = arguments.methods.split(";"), arguments.tasks.split(",")
    results = json.loads(arguments.results.read_text()) if arguments.results.exists() else {}
    if not arguments.table:
        jobs = [(m, t, s) for s in range(arguments.seeds) for t in tasks for m in methods]
        _run(jobs, results, arguments)
    kept = {key: found for key, found in results.items() if key.split("/")[1] in tasks}
    print(tables(kept))


def _run(jobs: list[tuple[str, str, int]], results: dict[str, Any], arguments: argparse.Namespace) -> None:
    """Run the jobs that have no result; every result is written down as soon as it is there."""
    missing = [job for job in jobs if arguments.fresh or _key(job) not in results]
    with ThreadPoolExecutor(arguments.workers) as pool:
        for job, done in zip(missing, pool.map(_started, missing), strict=True):
            if done.returncode:
                print(f"{_key(job)} failed:\n{done.stderr[-3000:]}", file=sys.stderr)
                continue
            results[_key(job)] = json.loads(done.stdout.splitlines()[-1])
            text = json.dumps(dict(sorted(results.items())), indent=1, ensure_ascii=False)
            arguments.results.write_text(text + "\n")
            print(_key(job), file=sys.stderr)


def _started(job: tuple[str, str, int]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, __file__, "--one", job[0], job[1], str(job[2])]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def _key(job: tuple[str, str, int]) -> str:
    return f"{job[0]}/{job[1]}/{job[2]}"


if __name__ == "__main__":
    main()
