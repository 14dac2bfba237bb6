"""The task of the cart, as a simulation test for TARL."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

mujoco = pytest.importorskip("mujoco", reason='MuJoCo is not installed: run pip install "tarl[mujoco]"')

GAP = Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=2, bins=16, unit="m")
SPEED = Sensor("speed", topic="/odom", field="twist.twist.linear.x", low=0, high=0.8, bins=8, unit="m/s")


@pytest.mark.tarl(
    nodes=["docking.py"],
    sensors=[GAP, SPEED],
    drifts={"loaded": {"payload": 30.0}, "wet": {"friction": 0.1}},
    episodes=60,
)
def test_docks(tarl: Tarl, tarl_drift: dict[str, float] | None) -> None:
    """Stop at the dock without touching it."""
    from world import World

    world = World(tarl.rng("world"), **(tarl_drift or {}))
    tarl.start("docking.py")
    while not (world.docked or world.failure):
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(**world.monitor())
    assert world.docked, world.failure
