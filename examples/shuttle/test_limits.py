"""How far may the shuttle's world change before a delivery fails? Run with `pytest --tarl-stress`."""

from typing import Any

import pytest
from test_shuttle import TERRAIN, X, drive
from world import World

from pytest_tarl import Drift, faults
from pytest_tarl.episode import Tarl


@pytest.mark.tarl(
    nodes=["traveller.py"],
    sensors=[X, TERRAIN],
    drifts={
        "world": Drift.space(
            mud=Drift.range(0.05, 1.0, nominal=1.0),
            offset=faults.bias("/odom", "pose.pose.position.x", -0.5, 0.5),
            late=faults.latency("/wheel_velocity", 0.5),
        )
    },
    must_hold={"mud": (0.9, 1.0)},
    min_success=0.98,
)
def test_delivers_within_limits(tarl: Tarl, tarl_drift: dict[str, Any]) -> None:
    """Bring one parcel from G1 to G2."""
    world = World(tarl.rng("world"), **tarl_drift)
    drive(tarl, "traveller.py", world)
    assert world.delivered, world.failure
