"""A simulator in a process of its own as the world of a node; a drift clogs its pump."""

import sys
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

SIMULATOR = Path(__file__).with_name("simulator.py")
STEPS = 20  # of 0.1 s

pytestmark = pytest.mark.skipif(
    PathFinder.find_spec("rclpy") is None, reason="the simulator needs a ROS 2: source its setup.bash"
)


@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10, unit="m")],
    drifts={"clogged": 0.4},
    tolerance=0.1,
    episodes=8,
)
def test_fills(tarl: Tarl, tarl_drift: float | None) -> None:
    """Fill the tank to 0.9 m within two seconds."""
    start = float(tarl.rng("world").uniform(0.0, 0.2))
    simulator = tarl.external(
        [sys.executable, str(SIMULATOR)],
        ready=("/level", "/valve"),
        step="/step",
        every_step=["/level"],
        environment={"START": repr(start), "PUMP": repr(tarl_drift or 1.0)},
    )
    tarl.start("keeper.py")
    for _ in range(STEPS):
        tarl.step(0.1)
        tarl.reward(-abs(1.0 - simulator.latest("/level").data))
    assert simulator.latest("/level").data > 0.9
