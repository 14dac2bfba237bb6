"""With the extra `bench`, every script of benchmarks/ starts, and every package that it imports is declared."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest

from tests.slow import SLOW

FOLDER = Path(__file__).parent.parent / "benchmarks"
SCRIPTS = sorted(
    path
    for path in [*FOLDER.glob("*.py"), *FOLDER.glob("drift/*.py")]
    if 'if __name__ == "__main__"' in path.read_text()
)
ROS = {"rospy", "rclpy", "std_msgs", "nav_msgs", "turtlebot3_msgs"}  # importable only within a node
# Arguments with which each script does as little as possible; {tmp} is a folder of the test with a package `one`.
SMALLEST = {
    "acceptance": ["--runs", "2"],
    "architecture_written": ["benchmarks/architecture_written/round1"],
    "bags": ["--seconds", "1"],
    "bound_coverage": ["--repetitions", "4", "--workers", "1"],
    "chain_coverage": ["--chains", "2"],
    "cost": ["--one", "pan_tracker", "10", "0"],
    "editing": ["{tmp}"],
    "episodes": ["--episodes", "2"],
    "fleet": ["--robots", "8", "--missions", "6", "--logs", "2"],
    "fleet_cost": [],
    "fleet_false_discoveries": ["--fleets", "2", "--robots", "10", "--missions", "20"],
    "flows_written": ["benchmarks/flows_written_7/judge"],
    "foreign_listings": ["{tmp}/packages", "{tmp}/listings"],
    "foreign_nodes": ["{tmp}/packages"],
    "formulas": [],
    "gate": ["--repetitions", "2", "--workers", "1", "--worlds", "track", "--sizes", "0"],
    "interpreted_programs": ["--count", "2"],
    "labelled_nodes": ["{tmp}/none.json", "{tmp}"],
    "launch_files": ["{tmp}/packages"],
    "limits": ["--share", "0.001"],
    "lint_labels": ["{tmp}", "{tmp}/none.json"],
    "lint_speed": ["--repetitions", "1", "--growth", "1", "--", "{tmp}"],
    "lint_summaries": ["{tmp}/packages"],
    "lint_truth": ["draw", "{tmp}/packages", "--seed", "1", "--each", "1"],
    "observe": ["--cycles", "20", "--blocks", "2"],
    "observe_day": ["--hours", "0.02", "--growth", "50"],
    "picture": ["--target", "{tmp}/picture.svg"],
    "readers_sample": ["--sentences", "20"],
    "recording": ["--quick"],
    "ros": ["--seconds", "0.05"],
    "run": [
        "--seeds",
        "1",
        "--methods",
        "random",
        "--tasks",
        "pan_tracker",
        "--results",
        "{tmp}/results.json",
    ],
    "same_world": [
        "--comparisons",
        "1",
        "--workers",
        "1",
        "--worlds",
        "shuttle",
        "--found",
        "{tmp}/found.json",
    ],
    "same_world_resampled": ["one_off_damage", "--episodes", "240", "--splits", "1"],
    "shared_episodes": ["--runs", "2"],
    "statistics_cost": [],
    "stress_dimensions": ["quiet_tank", "--harmless", "1"],
    "stress_worlds_4": ["--drifts", "2"],
    "system_flows": ["{tmp}"],
    "warm_pytest": [],
    "watch": ["speed", "--missions", "200"],
    "worlds": ["pipe_crawler", "--episodes", "2"],
    **{f"stress_worlds_{number}": ["--drifts", "1"] for number in (*range(5, 15), "slow")},
}
# Scripts without such a run: what they need, or how long their smallest run takes.
NOT_RUN = {
    "exhaustive": "minutes for a task, all of whose values it tries",
    "lint_codeql": "a checkout of github/codeql",
    "lint_pycg": "a checkout and an installation of PyCG",
    "mutants": "minutes: it copies the checkout; the job `mutants` runs it",
    "node_margins": "nodes of other projects, which real_nodes/bring.py copies from checkouts",
    "paper": "minutes: it repairs both examples",
    "parametric": "minutes: it repairs both examples",
    "stress": "minutes: an exhaustive grid of a task",
    "stress_repair": "minutes: it repairs a task and stresses it twice",
    "stress_worlds_3": "minutes: thousands of missions of a world",
    "third_party_suites": "the job `suites` runs it",
    "three_worlds": "rclpy",
}


def imported(path: Path) -> Iterator[str]:
    """Yield the packages that a script imports, at the top and within functions."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield (node.module or "").partition(".")[0]


def named(extras: set[str]) -> set[str]:
    """Return the normalised names of the direct requirements of tarl and its extras."""
    names, wanted = set[str](), {*extras}
    for _ in range(3):  # an extra may include other extras
        for line in requires("tarl") or ():
            requirement, _, marker = line.partition(";")
            extra = re.search(r"extra == ['\"](\w+)", marker)
            if extra is None or extra[1] in wanted:
                name = re.split(r"[\[<>=!~ ]", requirement)[0]
                names.add(re.sub(r"[-_.]+", "-", name).lower())
                if name == "tarl" and "[" in requirement:
                    wanted |= {*requirement.partition("[")[2].partition("]")[0].split(",")}
    return names


def test_packages_that_the_benchmarks_import_are_declared() -> None:
    known, allowed = packages_distributions(), named({"bench"})
    assert {"scipy", "pymunk", "numpy", "rosbags"} <= allowed
    own = {path.stem for path in FOLDER.rglob("*.py")} | {"pytest_tarl", "tarl_lint"} | ROS
    undeclared = {
        (path.name, name)
        for path in [*FOLDER.glob("*.py"), *FOLDER.glob("drift/*.py")]
        for name in imported(path)
        if name not in own | sys.stdlib_module_names
        and not {re.sub(r"[-_.]+", "-", one).lower() for one in known.get(name, [name])} & allowed
    }
    assert not undeclared


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_every_script_knows_its_smallest_run(script: Path) -> None:
    arguments = SMALLEST.get(script.stem, [])
    arguments = arguments[: arguments.index("--")] if "--" in arguments else arguments
    done = subprocess.run(
        [sys.executable, script, *arguments, "--help"], capture_output=True, text=True, cwd=FOLDER.parent
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: ")


def test_missing_smallest_run_has_a_reason() -> None:
    names = [path.stem for path in SCRIPTS]
    assert sorted(names) == sorted({*names}) == sorted([*SMALLEST, *NOT_RUN])


@pytest.mark.skipif(not SLOW, reason="minutes: set TARL_SLOW=1")
@pytest.mark.parametrize("name", SMALLEST)
def test_the_smallest_run_succeeds(name: str, tmp_path: Path) -> None:
    (script,) = (path for path in SCRIPTS if path.stem == name)
    (tmp_path / "node.py").write_text("import rospy\n")
    (tmp_path / "none.json").write_text("[]")
    (tmp_path / "packages" / "one").mkdir(parents=True)
    (tmp_path / "packages" / "one" / "node.py").write_text("import rospy\n")
    arguments = [argument.format(tmp=tmp_path) for argument in SMALLEST[name]]
    done = subprocess.run(
        [sys.executable, script, *arguments],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        cwd=FOLDER.parent,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.strip() or list(tmp_path.iterdir())
