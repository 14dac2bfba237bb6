"""The examples on a real ROS are recorded, compared and repaired as on the embedded one."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import sys
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
ROSPY, RCLPY = (PathFinder.find_spec(name) is not None for name in ("rospy", "rclpy"))
HERE = [
    pytest.param(
        "shuttle",
        "test_shuttle.py::test_delivers",
        r"accepted: 5 →",
        marks=pytest.mark.skipif(not ROSPY, reason="rospy is not installed here: make test-ros1"),
    ),
    pytest.param(
        "line_follower",
        "test_line_follower.py::test_follows_the_line",
        r"accepted: (KP →|scale KP\s+by\s+\(light)",  # both suit the weaker light
        marks=pytest.mark.skipif(not RCLPY, reason="rclpy is not installed here: make test-ros2"),
    ),
]
# The acceptance test is the same on any ROS and has tests of its own; here 8 pairs of episodes suffice
QUICK_ACCEPTANCE = """
from pytest_tarl.repairing import accepting
from pytest_tarl.searching import accept

accept.SEEDS = accepting.SEEDS = 16
accept.EARLY, accept.LOOKS = (), (8,)
accepting.risk_of = lambda alpha, before: 0.9
"""


def run(folder: Path, *options: str) -> str:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=3000)
    return done.stdout + done.stderr


@pytest.mark.parametrize(("example", "test", "repair"), HERE)
def test_real_ros_gives_the_results_of_the_embedded_one(
    tmp_path: Path, example: str, test: str, repair: str
) -> None:
    digests = {}
    for kind in ("embedded", "real"):
        folder = tmp_path / kind
        shutil.copytree(EXAMPLES / example, folder, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
        told = run(folder, test, "--tarl-record", "--tarl-episodes=20", f"--tarl-ros={kind}")
        assert "1 passed" in told, told
        (fixture,) = folder.glob(".tarl/utility/*.npz")
        digests[kind] = hashlib.sha256(fixture.read_bytes()).hexdigest()
    assert digests["real"] == digests["embedded"]
    tmp_path.joinpath("real", "conftest.py").write_text(QUICK_ACCEPTANCE)
    told = run(
        tmp_path / "real", test, "--tarl-online", "--tarl-repair", "--tarl-ros=real", "--tarl-episodes=16"
    )
    assert ": degraded" in told, told
    assert re.search(repair, told), told
    assert told.splitlines()[-1].startswith("git apply "), told
