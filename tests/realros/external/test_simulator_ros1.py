"""A simulator on a real ROS 1: its own master, clock, topics and services."""

from __future__ import annotations

import subprocess
import sys
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

from pytest_tarl.errors import SimulatorLostError
from tests.realros.external.test_simulator import STEPPED, Run, expected, guarded

pytestmark = pytest.mark.skipif(
    PathFinder.find_spec("rospy") is None or PathFinder.find_spec("rclpy") is not None,
    reason="rospy is not installed here: make test-ros1",
)
COMMAND = [sys.executable, str(Path(__file__).with_name("tank_simulator_ros1.py"))]
__all__ = ["guarded"]  # ends the guardian after the tests of this file
PROJECT = """
import sys
import pytest
from pytest_tarl import Sensor

@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)],
    drifts={{"clogged": 0.25}},
)
def test_fills(tarl, tarl_drift):
    simulator = tarl.external({command!r}, ready=("/level", "/valve"), step="/step", every_step=["/level"],
                              environment={{"PUMP": str(tarl_drift or 1.0)}}, timeout=600, patience=300)
    tarl.start("keeper.py")
    for _ in range(20):
        tarl.step(0.1)
        tarl.reward(-abs(1.0 - simulator.latest("/level").data))
    assert simulator.latest("/level").data > 0.9
"""
NODE = """
import rospy
from std_msgs.msg import Float64

level = None

def on_level(msg):
    global level
    level = msg.data

rospy.init_node("keeper")
rospy.Subscriber("/level", Float64, on_level)
valve = rospy.Publisher("/valve", Float64, queue_size=1)
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    if level is not None:
        valve.publish(2.0 * (1.0 - level))
    rate.sleep()
"""


def test_a_stepped_simulator_gives_the_same_levels_each_time(tmp_path: Path) -> None:
    for _ in range(2):  # each run has its own master
        with Run(tmp_path, command=COMMAND, **STEPPED) as run:
            assert run.steps(5) == pytest.approx(expected(5))
            assert run.simulator.clock == pytest.approx(0.6)


def test_a_reset_keeps_the_process_for_the_next_episode(tmp_path: Path) -> None:
    with Run(tmp_path, command=COMMAND, reset="/reset", **STEPPED) as first:
        levels = first.steps(3)
        client = first.simulator._client
    with Run(tmp_path, command=COMMAND, reset="/reset", **STEPPED) as second:
        assert second.steps(3) == levels
        assert second.simulator._client is client


def test_nodes_follow_a_free_running_ros1_clock(tmp_path: Path) -> None:
    with Run(tmp_path, {"OWN_TIME": "1"}, command=COMMAND) as run:
        before = run.simulator.clock
        run.steps(5)
        assert run.simulator.clock >= before + 0.5


@pytest.mark.parametrize("fault", ["die 4", "leave 4"])
def test_dead_simulator_error_has_its_last_output(tmp_path: Path, fault: str) -> None:
    with (
        Run(tmp_path, {"FAULT": fault}, command=COMMAND, **STEPPED) as run,
        pytest.raises(SimulatorLostError, match=r"ended with status 3 .*out of water"),
    ):
        run.steps(10)


def test_a_node_can_be_recorded_against_the_simulator(tmp_path: Path) -> None:
    (tmp_path / "keeper.py").write_text(NODE)
    (tmp_path / "test_tank.py").write_text(PROJECT.format(command=COMMAND))
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--tarl-record", "--tarl-episodes=3"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=3000, check=False)
    assert "1 passed" in done.stdout, done.stdout + done.stderr
    assert "not reproducible" not in done.stdout
