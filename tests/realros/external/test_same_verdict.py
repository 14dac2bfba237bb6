"""One test on the in-process ROS, on real rclpy in lock-step, and against an external simulator: the same verdict."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

from tests.realros.external.tank_project import write

pytestmark = [
    pytest.mark.skipif(
        PathFinder.find_spec("rclpy") is None, reason="rclpy is not installed here: make test-ros2"
    ),
    pytest.mark.skipif(
        not os.environ.get("TARL_SLOW"), reason="twenty seconds in real time: set TARL_SLOW=1"
    ),
]
EXAMPLE = Path(__file__).parents[3] / "examples" / "tank_external"
KINDS = {"in-process": (), "lock-step": ("--tarl-ros=real",), "external": ()}


def run(folder: Path, *options: str) -> str:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=3000)
    return done.stdout + done.stderr


def test_all_kinds_of_ros_give_one_verdict(tmp_path: Path) -> None:
    verdicts = {}
    for kind, flags in KINDS.items():
        folder = write(tmp_path / kind, external=kind == "external")
        told = run(folder, "--tarl-record", "--tarl-episodes=4", *flags)
        assert "1 passed" in told, told
        assert "not reproducible" not in told
        told = run(folder, "--tarl-online", "--tarl-episodes=4", *flags)
        (path,) = (folder / ".tarl" / "results").glob("*.json")
        found = json.loads(path.read_text())
        verdicts[kind] = found["verdict"]
    assert verdicts["in-process"]["result"] == "degraded"
    assert verdicts["lock-step"] == verdicts["external"] == verdicts["in-process"]


def test_the_example_gives_the_same_recording_with_two_workers(tmp_path: Path) -> None:
    recordings = []
    for workers in ("1", "2"):
        folder = tmp_path / workers
        shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
        test = folder / "test_tank.py"
        patient = test.read_text().replace(
            "\n        step=", "\n        timeout=900.0,\n        patience=300.0,\n        step="
        )
        assert patient.count("timeout=") == 1  # a busy machine may take more than the default of a minute
        test.write_text(patient)
        told = run(folder, "--tarl-record", "--tarl-episodes=4", f"--tarl-workers={workers}")
        assert "1 passed" in told, told
        (path,) = (folder / ".tarl" / "utility").glob("*.npz")
        recordings.append(path.read_bytes())
    assert recordings[0] == recordings[1]
