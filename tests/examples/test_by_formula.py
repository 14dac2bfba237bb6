"""Each drift of an example with formulas violates a formula."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.examples.driving import EXAMPLES

pytest.importorskip("rtamt")


@pytest.mark.parametrize(
    ("example", "drift", "formula"),
    [
        ("shuttle", "mud", "eventually[0:13.5] always[0:0.9] (abs(ahead) < 0.2)"),
        pytest.param(
            "quadrotor",
            "payload",
            "always[4:20] ((z > 1.4 and z < 3.9) or descending)",
            marks=pytest.mark.skipif(not os.environ.get("TARL_SLOW"), reason="set TARL_SLOW=1"),
        ),
    ],
)
def test_each_drift_violates_a_formula(tmp_path: Path, example: str, drift: str, formula: str) -> None:
    project = tmp_path / example
    shutil.copytree(EXAMPLES / example, project, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))

    def run(*flags: str) -> str:
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            "test_by_formula.py",
            *flags,
        ]
        return subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=120).stdout

    assert "success 100 %" in run("--tarl-record", "--tarl-episodes=16")
    assert f"{formula}: designed" in " ".join(
        run("--tarl-online", "--tarl-episodes=10", f"--tarl-drift={drift}").split()
    )
    (path,) = project.glob(".tarl/results/*.json")
    rows = {row["formula"]: row["worlds"] for row in json.loads(path.read_text())["formulas"]}
    assert rows[formula]["offline"]["violated"] == 0
    assert rows[formula]["online"]["violated"] > 0
    assert rows[formula]["online"]["robustness"] < rows[formula]["offline"]["robustness"]
