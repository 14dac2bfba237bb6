"""Each task of the drift benchmark has one drift, and its answer names sensors and statements that exist."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.slow import SLOW

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
JUDGING = (
    "drift_judging",
    "drift_judging_2",
    "drift_judging_3",
    "drift_judging_4",
    "drift_judging_5",
    "drift_judging_6",
    "drift_judging_7",
    "drift_judging_8",
    "drift_judging_9",
    "drift_judging_10",
    "drift_judging_11",
    "drift_judging_12",
    "drift_judging_13",
    "drift_judging_14",
    "drift_judging_15",
    "drift_judging_16",
    "drift_judging_17",
    "drift_judging_18",
    "drift_judging_19",
    "drift_judging_20",
    "drift_judging_21",
    "drift_judging_22",
    "drift_judging_23",
    "drift_judging_24",
    "drift_judging_25",
    "drift_judging_26",
    "drift_structure",
)
TASKS = sorted(
    test.parent for folder in ("drift", *JUDGING) for test in BENCHMARKS.glob(f"{folder}/*/test_*.py")
)
WRITTEN_BY_HAND = [task for task in TASKS if task.parent.name in JUDGING]


def answer(task: Path) -> dict[str, Any]:
    """Return the answer of a task."""
    found: dict[str, Any] = json.loads((task / "answer.json").read_text())
    return found


def marker(task: Path) -> dict[str, ast.expr]:
    """Return the arguments of the test's marker."""
    (test,) = task.glob("test_*.py")
    calls = [node for node in ast.walk(ast.parse(test.read_text())) if isinstance(node, ast.Call)]
    (found,) = (call for call in calls if ast.unparse(call.func) == "pytest.mark.tarl")
    return {keyword.arg: keyword.value for keyword in found.keywords if keyword.arg}


def test_there_are_tasks_in_every_folder() -> None:
    assert {task.parent.name for task in TASKS} == {"drift", *JUDGING}
    assert len(WRITTEN_BY_HAND) >= 20


@pytest.mark.parametrize("task", TASKS, ids=lambda task: f"{task.parent.name}/{task.name}")
def test_a_task_has_one_drift_and_its_nodes(task: Path) -> None:
    marked = marker(task)
    assert isinstance(marked["drifts"], ast.Dict)
    assert len(marked["drifts"].keys) == 1
    for node in ast.literal_eval(marked["nodes"]):
        compile((task / node).read_text(), node, "exec")


@pytest.mark.parametrize("task", TASKS, ids=lambda task: f"{task.parent.name}/{task.name}")
def test_an_answer_names_sensors_and_statements_that_exist(task: Path) -> None:
    known, marked = answer(task), marker(task)
    assert isinstance(marked["sensors"], ast.List)
    sensors = {
        ast.literal_eval(call.args[0]) for call in marked["sensors"].elts if isinstance(call, ast.Call)
    }
    assert {condition["sensor"] for condition in known["where"]} <= sensors
    nodes = [Path(name) for name in ast.literal_eval(marked["nodes"])]
    statements = {
        ast.unparse(one) for name in nodes for one in ast.walk(ast.parse((task / name).read_text()))
    }
    heads = {text.split("\n")[0] for text in statements}
    for site in (site for sites in known["right"] for site in sites):
        module, _, rest = site.partition(":")
        assert module in {name.stem for name in nodes}
        assert rest.partition(":")[2].partition(" #")[0] in heads, site
    assert known["repairable"] == bool(known["right"])


@pytest.mark.parametrize("task", WRITTEN_BY_HAND, ids=lambda task: f"{task.parent.name}/{task.name}")
def test_a_repair_by_hand_fits_its_files(task: Path, tmp_path: Path) -> None:
    known = answer(task)
    assert known["repairable"] == bool(known["hand"])
    assert bool(known["known"]) == (known["kind"] not in ("structure", "unrepairable"))
    texts = {name: (task / name).read_text() for name, _, _ in known["hand"]}
    for name, old, new in known["hand"]:
        assert texts[name].count(old) == 1, (name, old)
        texts[name] = texts[name].replace(old, new)
    for name, text in texts.items():
        if name.endswith(".py"):
            compile(text, name, "exec")


def test_second_half_has_every_kind_of_defect() -> None:
    kinds = [answer(task)["kind"] for task in WRITTEN_BY_HAND if task.parent.name == "drift_judging_2"]
    assert {kind: kinds.count(kind) for kind in kinds} == {
        "permanent": 2,
        "structure": 1,
        "range": 1,
        "rare failures": 2,
        "narrow window": 2,
        "sparse reward": 1,
        "unrepairable": 1,
    }


def test_third_set_has_every_kind_of_defect() -> None:
    third = [answer(task) for task in WRITTEN_BY_HAND if task.parent.name == "drift_judging_3"]
    kinds = [known["kind"] for known in third]
    assert {kind: kinds.count(kind) for kind in kinds} == {
        "permanent": 1,
        "structure": 3,
        "range": 1,
        "rare failures": 2,
        "narrow window": 1,
        "sparse reward": 1,
        "unrepairable": 1,
    }
    assert all(known["practice"] for known in third)


KINDS = {  # kinds of defects in the tasks of each set
    "drift_judging_4": [
        "helper",
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "structure",
        "two constants",
        "unrepairable",
    ],
    "drift_judging_6": [
        "helper",
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "two constants",
        "two constants",
        "unrepairable",
    ],
    "drift_judging_7": [
        "helper",
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "structure",
        "two constants",
        "unrepairable",
    ],
    "drift_judging_8": ["helper", "permanent", "range", "sparse reward"],
    "drift_judging_9": [
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "two constants",
    ],
    "drift_judging_10": [
        "helper",
        "narrow window",
        "one constant",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "two constants",
    ],
    "drift_judging_11": [
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "two constants",
    ],
    "drift_judging_12": [
        "narrow window",
        "one constant",
        "permanent",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "two constants",
    ],
    "drift_judging_13": [
        "narrow window",
        "one constant",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "structure",
    ],
    "drift_judging_14": [
        "narrow window",
        "one constant",
        "permanent",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "structure",
    ],
    "drift_judging_15": [
        "narrow window",
        "one constant",
        "permanent",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "two constants",
    ],
    "drift_judging_16": [
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "structure",
        "structure",
        "structure",
        "two constants",
    ],
    "drift_judging_17": [
        "narrow window",
        "one constant",
        "one constant",
        "one constant",
        "permanent",
        "rare failures",
        "structure",
        "structure",
    ],
    "drift_judging_18": [
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
    ],
    "drift_judging_19": [
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "two constants",
    ],
    "drift_judging_20": [
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "structure",
        "two constants",
    ],
    "drift_judging_21": [
        "narrow window",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "structure",
        "two constants",
    ],
    "drift_judging_22": [
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "sparse reward",
        "structure",
        "two constants",
    ],
    "drift_judging_23": [
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "two constants",
    ],
    "drift_judging_24": [
        "helper",
        "helper",
        "one constant",
        "one constant",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "two constants",
    ],
    "drift_judging_25": [
        "helper",
        "one constant",
        "one constant",
        "one constant",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "structure",
        "structure",
        "two constants",
    ],
    "drift_judging_26": [
        "helper",
        "narrow window",
        "one constant",
        "one constant",
        "permanent",
        "range",
        "rare failures",
        "sparse reward",
        "structure",
        "structure",
        "structure",
        "two constants",
    ],
}


@pytest.mark.parametrize("folder", KINDS)
def test_each_set_has_every_kind_of_defect(folder: str) -> None:
    known = [answer(task) for task in WRITTEN_BY_HAND if task.parent.name == folder]
    assert sorted(one["kind"] for one in known) == KINDS[folder]
    assert all(one["practice"] for one in known)


Rates = dict[str, tuple[float, float]]


def worlds(folder: str, *options: str) -> tuple[Rates, Rates]:
    """Return success and average total reward of a set's tasks, each in the designed and in the drifted world."""
    command = [sys.executable, BENCHMARKS / "drift" / "worlds.py", "--folder", BENCHMARKS / folder, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=BENCHMARKS.parent)
    rows = [[cell.strip() for cell in line.split("|")] for line in done.stdout.splitlines() if " / " in line]
    success, reward = (
        {row[1]: (float(pair[0]), float(pair[1])) for row in rows[1:] for pair in [row[column].split(" / ")]}
        for column in (5, 6)
    )
    return success, reward


def test_hand_repair_restores_a_fourth_task() -> None:
    success, _ = worlds("drift_judging_4", "press_brake", "--by-hand", "--episodes", "2")
    assert success == {"press_brake": (1.0, 1.0)}


@pytest.mark.skipif(not SLOW, reason="minutes: set TARL_SLOW=1")
def test_the_worlds_of_the_fourth_set_are_deterministic() -> None:
    once, again = (worlds("drift_judging_4", "--episodes", "5") for _ in range(2))
    assert once == again
    assert len(once[0]) == 10


@pytest.mark.skipif(not SLOW, reason="minutes: set TARL_SLOW=1")
@pytest.mark.parametrize(
    "folder",
    [
        "drift_judging_3",
        "drift_judging_4",
        "drift_judging_6",
        "drift_judging_7",
        "drift_judging_8",
        "drift_judging_9",
        "drift_judging_10",
        "drift_judging_11",
        "drift_judging_12",
        "drift_judging_13",
        "drift_judging_14",
        "drift_judging_15",
        "drift_judging_16",
        "drift_judging_17",
        "drift_judging_18",
        "drift_judging_19",
        "drift_judging_20",
        "drift_judging_21",
        "drift_judging_22",
        "drift_judging_23",
        "drift_judging_24",
        "drift_judging_25",
        "drift_judging_26",
    ],
)
def test_hand_repairs_restore_the_reward(folder: str) -> None:
    tasks = [task for task in WRITTEN_BY_HAND if task.parent.name == folder]
    before, after = worlds(folder)[0], worlds(folder, "--by-hand")[0]
    assert set(before) == set(after) == {task.name for task in tasks}
    for task in tasks:
        designed, drifted = before[task.name]
        assert designed >= 0.98, task.name
        assert drifted <= (0.95 if answer(task)["kind"] == "rare failures" else 0.05), task.name
        permanent = "permanent=True" in ast.unparse(marker(task)["drifts"])
        if answer(task)["repairable"]:
            assert after[task.name][1] >= 0.98, task.name
            assert permanent or after[task.name][0] >= 0.98, task.name
