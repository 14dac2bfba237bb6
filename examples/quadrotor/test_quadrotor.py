"""The task of the quadrotor, as a simulation test for TARL."""

import pytest
from world import World

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

ALONG = Sensor("x", topic="/pose", field="pose.position.x", low=-0.5, high=6.5, bins=14, unit="m")
UP = Sensor("z", topic="/pose", field="pose.position.z", low=0, high=4, bins=8, unit="m")


@pytest.mark.tarl(
    nodes=["guidance.py", "attitude.py"],
    sensors=[ALONG, UP],
    drifts={"payload": {"payload": 0.4}, "gust": {"gust": 1.8}},
    episodes=100,
    min_success=0.98,
)
def test_flies_its_mission(tarl: Tarl, tarl_drift: dict[str, float] | None) -> None:
    """Take off, pass two waypoints, land softly."""
    world = World(tarl.rng("world"), **(tarl_drift or {}))
    tarl.start("guidance.py")
    tarl.start("attitude.py")
    while not world.over:
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(**world.monitor())
    assert world.landed, world.failure
