"""Signals that a test observes need no declaration: their names are read from its source."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.formula_calls import said
from pytest_tarl.formulas.said import NOTHING_SAID

TEST = """\
import helpers
from world import *

class TestRobot:
    def test_drives(self, tarl):
        tarl.observe(gap=1.0, **{"ahead": 2.0})
        tarl.require("always (gap > 0)")
        tarl.require(formula=TEXT)
        def inner():
            self.tarl.observe(nested=1)

    def test_other(self, tarl):
        tarl.observe(other=1)

def test_else(tarl):
    tarl.observe(elsewhere=1)

def helper(tarl):
    tarl.observe(helped=True)
"""


def project(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / f"{name}.py").write_text(text)
    return folder


def test_names_are_read_from_the_test_and_its_imports(tmp_path: Path) -> None:
    project(
        tmp_path,
        test_robot=TEST,
        helpers="def tell(tarl): tarl.observe(distance=3)",
        world="import os",
        unused="def tell(tarl): tarl.observe(never=3)",
    )
    found = said("test_robot.py::TestRobot::test_drives[0.5-mud]", tmp_path)
    assert {*found.observed} == {"gap", "ahead", "nested", "helped", "distance"}
    assert found.texts == ("always (gap > 0)",)
    assert found.requires
    assert not found.computed


@pytest.mark.parametrize(
    "call", ["tarl.observe(**values)", "tarl.observe(**{name: 1})", "tarl.observe(**{**a})"]
)
def test_computed_names_are_detected(tmp_path: Path, call: str) -> None:
    project(tmp_path, test_robot=f"def test_drives(tarl):\n    {call}\n")
    assert said("test_robot.py::test_drives", tmp_path).computed


@pytest.mark.parametrize(
    "text", ["def test_drives(tarl): pass", "tarl.observe(", "", "tarl.observe(gap=1)\0"]
)
def test_an_empty_or_invalid_source_has_no_names(tmp_path: Path, text: str) -> None:
    project(tmp_path, test_robot=text)
    assert said("test_robot.py::test_drives", tmp_path) == NOTHING_SAID
    assert said("gone.py::test_drives", tmp_path) == NOTHING_SAID


def test_the_source_is_parsed_but_never_run(tmp_path: Path) -> None:
    project(
        tmp_path, test_robot=f"open({str(tmp_path / 'ran')!r}, 'w')\ndef test_drives(tarl): tarl.observe(a=1)"
    )
    assert said("test_robot.py::test_drives", tmp_path).observed == ("a",)
    assert not (tmp_path / "ran").exists()
