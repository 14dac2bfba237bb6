"""Kept episodes are used again only under the same conditions: which files and settings count, and what is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.designation import Designation
from pytest_tarl.options import Options
from pytest_tarl.resuming.run_conditions import changed, conditions
from pytest_tarl.sensors import Sensor

SETTINGS = {
    "the sensors",
    "--tarl-seed",
    "--tarl-ros",
    "the version of tarl",
    "the version of numpy",
    "the version of Python",
    "the machine",
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    files = {
        "tests/test_it.py": "import world\n\ndef test_it(): pass\n",
        "tests/other.py": "x = 1\n",
        "world.py": "LEVEL = 1\n",
        "robot/node.py": "print(1)\n",
        "robot/inner/part.py": "print(2)\n",
        "robot/notes.txt": "x",
        "robot/.venv/lib.py": "print(3)\n",
        "robot/__pycache__/old.py": "print(4)\n",
        "robot/inner/.git/hook.py": "print(5)\n",
        "robot/.tarl/kept.py": "print(6)\n",
        "lib/recorded.py": "print(7)\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def found(project: Path, node: str = "../robot", **options: Any) -> dict[str, Any]:
    marked = Designation((node,), options.pop("sensors", (Sensor("level"),)))
    files = [project / "lib" / "recorded.py"]
    return conditions(
        "tests/test_it.py::test_it[a-b]", project / "tests", project, marked, Options(**options), files
    )


def test_files_are_those_of_the_nodes_and_the_test(
    project: Path,
) -> None:
    files = set(found(project)) - SETTINGS
    assert files == {
        "tests/test_it.py",
        "world.py",
        "robot/node.py",
        "robot/inner/part.py",
        "lib/recorded.py",
    }
    assert set(found(project, "../robot/node.py")) - SETTINGS == files - {"robot/inner/part.py"}
    assert set(found(project, "../robot/gone.py")) - SETTINGS == {
        "tests/test_it.py",
        "world.py",
        "lib/recorded.py",
    }


@pytest.mark.parametrize(
    ("file", "text", "counts"),
    [
        ("robot/node.py", "print(1)  # a comment in a node\n", True),
        ("lib/recorded.py", "print(8)\n", True),
        ("world.py", "LEVEL = 1  # a comment\n", False),
        ("world.py", "LEVEL = 2\n", True),
        ("tests/other.py", "x = 2\n", False),
        ("robot/.venv/lib.py", "print(9)\n", False),
    ],
)
def test_a_changed_file_changes_only_its_own_digest(
    project: Path, file: str, text: str, counts: bool
) -> None:
    before = found(project)
    (project / file).write_text(text)
    after = found(project)
    assert {name for name in before if before[name] != after[name]} == ({file} if counts else set())
    assert changed(before, after) == (f"{file} changed" if counts else "")


def test_foreign_files_are_named_by_whole_path(project: Path) -> None:
    names = set(
        conditions(
            "tests/test_it.py::test_it",
            project / "tests",
            project / "tests",
            Designation(("../robot/node.py",), ()),
            Options(),
            [],
        )
    )
    assert (project / "robot" / "node.py").resolve().as_posix() in names


def test_selecting_and_judging_settings_do_not_count(project: Path) -> None:
    assert found(project) == found(project, alpha=0.2, episodes=7, budget=3, workers=2)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"seed": 5}, "--tarl-seed was 0 and is 5"),
        ({"ros": "real"}, "--tarl-ros was embedded and is real"),
        ({"sensors": (Sensor("level", bins=2, low=0.0, high=1.0),)}, "the sensors changed"),
    ],
)
def test_settings_that_change_episodes_count(project: Path, options: Any, said: str) -> None:
    assert changed(found(project), found(project, **options)) == said


@pytest.mark.parametrize(
    ("before", "now", "said"),
    [
        ({"a.py": "1"}, {"a.py": "1"}, ""),
        ({"a.py": "1"}, {"a.py": "2"}, "a.py changed"),
        ({"a.py": "1"}, {}, "a.py no longer takes part"),
        ({}, {"a.py": "1"}, "a.py is new"),
        ({"b": "1", "a": "1"}, {"b": "2", "a": "2"}, "a changed; b changed"),
        (dict.fromkeys("dcba", 1), dict.fromkeys("abcd", 2), "a changed; b changed; c changed and 1 more"),
        (dict.fromkeys("cba", 1), dict.fromkeys("abc", 2), "a changed; b changed; c changed"),
        (
            {"the version of numpy": "1", "the machine": "x"},
            {"the version of numpy": "2", "the machine": "y"},
            "the machine was x and is y; the version of numpy was 1 and is 2",
        ),
        ({"--tarl-seed": "1"}, {}, "--tarl-seed was 1 and is None"),
    ],
)
def test_at_most_three_changes_are_named(before: Any, now: Any, said: str) -> None:
    assert changed(before, now) == said


def test_reordered_sensors_are_other_conditions(project: Path) -> None:
    first, second = Sensor("level"), Sensor("flow")
    both = found(project, sensors=(first, second))
    assert both == found(project, sensors=(replace(first), second))
    assert changed(both, found(project, sensors=(second, first))) == "the sensors changed"
