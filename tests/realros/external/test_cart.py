"""A cart in MuJoCo: one test on the in-process ROS, on real rclpy in lock-step, and against a simulator that fails.

The simulator is a process of its own on real rclpy that sometimes dies, hangs, starts slowly or publishes late.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path

import pytest

from pytest_tarl.external.arguments import setup
from pytest_tarl.external.kept_simulator import KEPT
from pytest_tarl.external.simulator import Simulator
from pytest_tarl.ros import Ros
from tests.realros.external.cart_project import write

pytestmark = [
    pytest.mark.skipif(
        PathFinder.find_spec("rclpy") is None, reason="rclpy is not installed here: make test-ros2"
    ),
    pytest.mark.skipif(find_spec("mujoco") is None, reason="MuJoCo is not installed here: make test-ros2"),
]
SIMULATOR = Path(__file__).with_name("cart_simulator.py")
EPISODES = "--tarl-episodes=4"
KINDS = {"in-process": (), "lock-step": ("--tarl-ros=real",), "external": ()}
# `hang` needs a patience that a busy machine does not exceed in a step of a sound simulator
FAULTS = {"FAULTS": "die 20,hang 20,slow 1,late 0.02", "PATIENCE": "8"}


def run(folder: Path, *options: str, **environment: str) -> str:
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", EPISODES, *options]
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, timeout=3000
    )
    return done.stdout + done.stderr


def test_verdict_is_the_same_with_each_ros(tmp_path: Path) -> None:
    verdicts = {}
    for kind, flags in KINDS.items():
        folder = write(tmp_path / kind)
        world = "Outside" if kind == "external" else "Inside"
        told = run(folder, "--tarl-record", *flags, WORLD=world, **(FAULTS if kind == "external" else {}))
        assert "1 passed" in told, told
        assert "not reproducible" not in told
        if kind == "external":
            assert "2 of 5 episodes lost their simulator and were run again with a new one" in told, told
            assert "1 × it ended with status 3 (last output: the wheels came off)" in told
            assert "1 × it did not answer on /step (last output: the wheels came off)" in told
        told = run(folder, "--tarl-online", *flags, WORLD=world)
        (path,) = (folder / ".tarl" / "results").glob("*.json")
        verdicts[kind] = json.loads(path.read_text())["verdict"]
    assert verdicts["in-process"]["result"] == "degraded", told
    # A message that the simulator publishes late may change the loss from the eighth digit on.
    losses = [verdict.pop(loss) for verdict in verdicts.values() for loss in ("loss", "detectable_loss")]
    assert losses == pytest.approx(losses[:2] * len(KINDS), abs=1e-6)
    assert verdicts["lock-step"] == verdicts["external"] == verdicts["in-process"]


def test_reset_keeps_the_process(tmp_path: Path) -> None:
    found = []
    for _ in range(2):
        arguments = setup(
            [sys.executable, str(SIMULATOR)], tmp_path, environment={"X": "0.1"}, clock="/clock",
            ready=("/odom", "/cmd_vel"), step="/step", reset="/reset", every_step=("/odom",), timeout=600.0,
            patience=300.0,
        )  # fmt: skip
        simulator = Simulator(arguments, Ros(), [])
        simulator.begin()
        start = simulator.latest("/odom").pose.pose.position.x
        for _ in range(3):
            simulator.advance(0.05)
        found.append((simulator._client, start, simulator.latest("/odom"), simulator.clock))
        simulator.end()
    KEPT.close()
    assert found[0] == found[1]
    assert found[0][1] == 0.1
    assert found[0][3] == pytest.approx(0.2)
