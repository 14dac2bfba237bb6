"""Run the benchmark: every method on every task with every seed, side by side, and print the tables.

    python benchmarks/drift/run.py [--seeds 10] [--methods ours;random;…] [--tasks TASK,…] [--workers 2]
        [--folder benchmarks/drift]

Results are kept in `results.json` in the folder of the tasks, one entry per method, task and seed. Existing entries
are not run again, so a run can be interrupted and continued; `--fresh` forgets the entries of the requested methods
and tasks. `--table` prints the tables from the existing entries. CMA-ES and Optuna need `pip install cma optuna`;
FauxPy, which pins other plugins of pytest, needs an environment of its own that also has tarl: `--fauxpy PYTHON`
names its Python.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from fauxpy_peer import FAUXPY, localised
from stage import HERE, Stage, answers_in, tasks_in, visit
from table import tables

OURS = {  # method → search; all of them face the same acceptance test
    "ours": "sweep",
    "ours, halving": "halving",
    "random, same acceptance": "random_search:Random",
}
PEERS = ("random", "CMA-ES", "Optuna")
METHODS = ("ours", *(f"{name}{guard}" for name in PEERS for guard in ("", ", our guard")), *FAUXPY)


def one(home: Path, methods: Sequence[str], task: str, seed: int, python: str | None) -> dict[str, Any]:
    """Run methods on a copy of one task with one seed; steps that they have in common are done once."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve() / task
        shutil.copytree(home / task, copy, ignore=shutil.ignore_patterns("__pycache__"))
        found: dict[str, Any] = visit(task, lambda stage: _found(stage, methods, seed, python), copy, home)
    return found


def _found(stage: Stage, methods: Sequence[str], seed: int, python: str | None) -> dict[str, Any]:
    from ours import ours, prepared
    from peers import BUDGET, peer

    if methods[0] in OURS:
        return {name: ours(stage, seed, OURS[name]) for name in methods}
    if methods[0] in FAUXPY:
        return {name: localised(stage, seed, name, python) for name in methods}
    order = prepared(stage, seed, BUDGET)
    return {name: peer(order, seed, name.partition(", ")[0], "guard" in name) for name in methods}


def main() -> None:
    """Run the missing entries, each task and seed in its own process, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--methods", default=";".join(METHODS), help="methods, separated by semicolons")
    parser.add_argument("--folder", type=Path, default=HERE, help="folder of the tasks")
    parser.add_argument("--tasks", help="tasks, separated by commas (default: all in the folder)")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--results", type=Path, help="file of results (default: results.json in the folder)")
    parser.add_argument(
        "--fresh", action="store_true", help="forget earlier results of the requested methods and tasks"
    )
    parser.add_argument("--table", action="store_true", help="only print the tables of earlier results")
    parser.add_argument(
        "--fauxpy", metavar="PYTHON", help="Python of an environment that has fauxpy and tarl"
    )
    parser.add_argument("--one", nargs=3, metavar=("METHODS", "TASK", "SEED"), help="print results as JSON")
    arguments = parser.parse_args()
    home = arguments.folder = arguments.folder.resolve()
    arguments.results = arguments.results or home / "results.json"
    if arguments.one:
        methods, task, seed = arguments.one
        found = one(home, methods.split(";"), task, int(seed), arguments.fauxpy)
        print("\n" + json.dumps(found, ensure_ascii=False))
        return
    tasks = arguments.tasks.split(",") if arguments.tasks else tasks_in(home)
    results = json.loads(arguments.results.read_text()) if arguments.results.exists() else {}
    if not arguments.table:
        _run(_jobs(arguments, tasks, {} if arguments.fresh else results), results, arguments)
    kept = {key: found for key, found in results.items() if key.split("/")[1] in tasks}
    print(tables(kept, answers_in(home)))


Job = tuple[tuple[str, ...], str, int]  # methods, task, seed


def _jobs(arguments: argparse.Namespace, tasks: Sequence[str], results: Mapping[str, Any]) -> list[Job]:
    """Return the runs without a result: peers that share a recording run together, all other methods alone."""
    jobs = []
    asked = arguments.methods.split(";")
    peers = tuple(name for name in asked if name.partition(", ")[0] in PEERS and name not in OURS)
    groups = [peers, *((name,) for name in asked if name not in peers)]
    for seed in range(arguments.seeds):
        for task in tasks:
            for group in groups:
                missing = tuple(name for name in group if _key(name, task, seed) not in results)
                if missing and (seed == 0 or not missing[0].startswith("FauxPy MBFL")):
                    # FauxPy's analysis of mutants takes minutes, so it runs with one seed only
                    jobs.append((missing, task, seed))
    return jobs


def _run(jobs: Sequence[Job], results: dict[str, Any], arguments: argparse.Namespace) -> None:
    """Run jobs; write every result to the file as soon as it is known."""
    more = ["--folder", str(arguments.folder)]
    if arguments.fauxpy:
        more += ["--fauxpy", arguments.fauxpy]
    with ThreadPoolExecutor(arguments.workers) as pool:
        started = pool.map(lambda job: _started(job, more), jobs)
        for (methods, task, seed), done in zip(jobs, started, strict=True):
            if done.returncode:
                print(
                    f"{_key(';'.join(methods), task, seed)} failed:\n{done.stderr[-3000:]}", file=sys.stderr
                )
                continue
            for name, found in json.loads(done.stdout.splitlines()[-1]).items():
                results[_key(name, task, seed)] = found
                print(_key(name, task, seed), file=sys.stderr)
            text = json.dumps(dict(sorted(results.items())), indent=1, ensure_ascii=False)
            arguments.results.write_text(text + "\n")


def _started(job: Job, more: Sequence[str]) -> subprocess.CompletedProcess[str]:
    methods, task, seed = job
    command = [sys.executable, __file__, "--one", ";".join(methods), task, str(seed), *more]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def _key(method: str, task: str, seed: int) -> str:
    return f"{method}/{task}/{seed}"


if __name__ == "__main__":
    main()
