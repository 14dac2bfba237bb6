"""Partial repairs: shown with bounds, and never applied by accident."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.patch_reader import read
from tests.plugin.tank import ONLINE, RECORD, changed, result

TARL = (sys.executable, "-m", "pytest_tarl")
REPAIR = (*ONLINE, "--tarl-repair", "--tarl-constants", "--tarl-budget=60")


@pytest.fixture
def halfway(tank: pytest.Pytester) -> Path:
    """The partial repair of a tank whose valve no longer opens fully and whose pump is clogged."""
    changed(
        tank, "test_tank", "(valve.data if valve", "(min(valve.data, 2.0 if tarl_drift else 9.0) if valve"
    )
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = tank.runpytest(*REPAIR)
    told = " ".join(done.stdout.str().split())
    found = result(tank)["repair"]
    assert not found["accepted"]
    assert found["partial"]["low"] > 0
    assert found["partial"]["designed_low"] <= found["partial"]["designed"]
    assert re.search(r"partial: .*: the drift costs .* regains .* \(at least .*; in the designed world", told)
    (page,) = tank.path.glob(".tarl/report/*.html")
    assert "Partial repair, not accepted" in page.read_text()
    assert not list(tank.path.glob(".tarl/patches/*.patch"))
    return tank.path / str(found["partial"]["patch"])


def test_a_partial_repair_is_applied_only_on_explicit_request(halfway: Path, tank: pytest.Pytester) -> None:
    node = (tank.path / "keeper.py").read_text()
    for tool in (("git", "apply", str(halfway)), ("patch", "-p1", "-i", str(halfway))):
        subprocess.run(tool, cwd=tank.path, capture_output=True, check=False)
        assert (tank.path / "keeper.py").read_text() == node
    for refused in ("apply", "suggest"):
        done = tank.run(*TARL, refused, str(halfway))
        assert done.ret == 1
        done.stderr.fnmatch_lines(["*is a partial repair, which was not accepted*--partial*"])
    assert (tank.path / "keeper.py").read_text() == node
    assert tank.run(*TARL, "apply", "--partial", str(halfway)).ret == 0
    assert (tank.path / "keeper.py").read_text() != node
    assert tank.run(*TARL, "revert", str(halfway)).ret == 0
    assert (tank.path / "keeper.py").read_text() == node
    content = halfway.read_bytes()
    halfway.write_bytes(content.replace(b"| +", b"| + ", 1))
    with pytest.raises(RepairError, match="damaged"):
        read(halfway)


def test_candidate_without_a_certain_gain_is_no_partial_repair(tank: pytest.Pytester) -> None:
    changed(
        tank,
        "test_tank",
        "        level += 0.1 * pump *",
        "        level += 0.0 if tarl_drift else 0.1 * pump *",
    )
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR, "--tarl-budget=20")
    assert "partial" not in result(tank)["repair"]
    assert not list(tank.path.glob(".tarl/patches/*"))


def test_partial_repair_changes_the_definition(
    tank: pytest.Pytester,
) -> None:
    changed(tank, "keeper", "missing = 1.0 - level", "missing = (level < 9.0) - level")
    changed(tank, "test_tank", "low=0, high=1, bins=10", "low=-9, high=9, bins=1")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR, "--tarl-budget=4")
    (file,) = tank.path.glob(".tarl/patches/*.partial")
    assert "| -GAIN = 2.0\n| +GAIN = " in file.read_text()
