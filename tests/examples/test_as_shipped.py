"""The examples run without flags, as ordinary tests in their own folders."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.examples.driving import EXAMPLES

GYMNASIUM, MUJOCO = (find_spec(name) is not None for name in ("gymnasium", "mujoco"))
FORMULAS = sys.version_info < (3, 13) and find_spec("rtamt") is not None


@pytest.mark.parametrize(
    ("example", "tests"),
    [
        *[("shuttle", 4), ("line_follower", 1), ("quadrotor", 1), ("workspace", 1)],
        pytest.param(
            "cart_mujoco", 1, marks=pytest.mark.skipif(not MUJOCO, reason="MuJoCo is not installed")
        ),
        pytest.param(
            "pole_gymnasium", 1, marks=pytest.mark.skipif(not GYMNASIUM, reason="Gymnasium is not installed")
        ),
    ],
)
def test_an_example_passes_without_flags_in_its_own_folder(example: str, tests: int) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=EXAMPLES / example,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    by_formula = (EXAMPLES / example / "test_by_formula.py").exists() and FORMULAS
    assert f"{tests + by_formula} passed" in run.stdout
    assert "TARL" not in run.stdout


def test_the_swapped_node_differs_only_in_the_order_of_two_lines() -> None:
    here, there = (
        (EXAMPLES / "shuttle" / f"{name}.py").read_text() for name in ("traveller", "traveller_swapped")
    )
    swapped = re.sub(r"( +err = .*\n)( +vel = .*\n)", r"\2\1", here)
    assert swapped != here
    assert swapped == there


def test_a_stress_run_finds_limits_of_the_shuttle(tmp_path: Path) -> None:
    copy = tmp_path / "shuttle"
    shutil.copytree(EXAMPLES / "shuttle", copy, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
    for flags in (("--tarl-record", "--tarl-episodes=10"), ("--tarl-stress", "--tarl-stress-budget=40")):
        run = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_limits.py", *flags],
            cwd=copy,
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert run.returncode == 0, run.stdout + run.stderr
    assert re.search(r"stress, \d+ episodes\n  guarantee .*\n  mud  ", run.stdout)
    assert "The budget of 40 episodes did not suffice" in run.stdout


def ran(folder: Path, *flags: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *flags],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
    )


@pytest.mark.skipif(not os.environ.get("TARL_SLOW"), reason="half a minute of CPU time; set TARL_SLOW=1")
def test_drift_of_a_launched_system_is_repaired_in_the_right_package(tmp_path: Path) -> None:
    copy = tmp_path / "workspace"
    shutil.copytree(EXAMPLES / "workspace", copy, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
    recorded = ran(copy, "--tarl-record", "--tarl-episodes=30")
    assert "30 of 30 missions succeeded" in recorded.stdout, recorded.stdout + recorded.stderr
    repaired = ran(
        copy, "--tarl-online", "--tarl-drift=worn tyres", "--tarl-repair", "--tarl-episodes=30"
    ).stdout
    assert "degraded" in repaired
    assert re.search(
        r"repair +accepted: 0\.2 → 0\.\d+ at\s+scout_navigation/scout_navigation/planner\.py", repaired
    )
    (patch,) = (copy / ".tarl" / "patches").glob("*.patch")
    assert re.findall(r"^\+\+\+ b/(.*)$", patch.read_text(), re.M) == [
        "scout_navigation/scout_navigation/planner.py"
    ]
