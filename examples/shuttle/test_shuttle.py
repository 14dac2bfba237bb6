"""The task of the delivery robot, as simulation tests for TARL."""

import pytest
from world import G1, G2, World

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

X = Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=12, bins=24, unit="m")
TERRAIN = Sensor("terrain", topic="/terrain", field="data")
LEG = Sensor("leg", topic="/leg", field="data")
MUD = {"mud": 0.1}  # share of the commanded speed that the robot reaches on the patch


def drive(tarl: Tarl, node: str, world: World) -> None:
    """Run one episode: let a node drive until its mission is over."""
    tarl.start(node)
    while not world.over:
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(world.monitor())


@pytest.mark.tarl(nodes=["traveller.py"], sensors=[X, TERRAIN], drifts=MUD, episodes=200, min_success=0.98)
def test_delivers(tarl: Tarl, tarl_drift: float | None) -> None:
    """Bring one parcel from G1 to G2."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0)
    drive(tarl, "traveller.py", world)
    assert world.delivered, world.failure


@pytest.mark.tarl(nodes=["traveller.py"], sensors=[X, TERRAIN, LEG], drifts=MUD, min_success=0.98)
def test_shuttles(tarl: Tarl, tarl_drift: float | None) -> None:
    """Deliver one parcel at the goal and one at the start; the position alone does not show the direction."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0, goals=(G2, G1))
    drive(tarl, "traveller.py", world)
    assert world.delivered, world.failure
