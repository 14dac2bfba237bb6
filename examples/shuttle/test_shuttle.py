"""What the delivery robot is for, as simulation tests that TARL can learn from."""

import pytest
from world import G1, G2, World

from pytest_tarl import Sensor

X = Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=12, bins=24, unit="m")
TERRAIN = Sensor("terrain", topic="/terrain", field="data")
LEG = Sensor("leg", topic="/leg", field="data")
MUD = {"mud": 0.1}  # what the patch leaves of the commanded speed


@pytest.mark.tarl(nodes=["traveller.py"], sensors=[X, TERRAIN], drifts=MUD, episodes=200, min_success=0.98)
def test_delivers(tarl, tarl_drift):
    """Bring one parcel from G1 to G2."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0)
    tarl.start("traveller.py")
    while not world.over:
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(world.monitor())
    assert world.delivered, world.failure


@pytest.mark.tarl(
    nodes=["traveller.py"], sensors=[X, TERRAIN, LEG], drifts=MUD, episodes=200, min_success=0.98
)
def test_shuttles(tarl, tarl_drift):
    """Bring one parcel from G1 to G2 and another one back: the leg says which way a position is passed."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0, goals=(G2, G1))
    tarl.start("traveller.py")
    while not world.over:
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(world.monitor())
    assert world.delivered, world.failure
