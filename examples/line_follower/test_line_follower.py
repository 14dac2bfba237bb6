"""The task of the line follower, as a simulation test for TARL."""

import pytest
from world import LENGTH, World

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

LIGHT = Sensor("light", topic="/light", field="illuminance", low=0, high=1000, bins=10, unit="lx")
COURSE = Sensor("course", low=0, high=LENGTH, bins=14, unit="m")  # only for the report


@pytest.mark.tarl(nodes=["line_follower.py"], sensors=[LIGHT, COURSE], drifts={"dusk": 0.35}, episodes=100)
def test_follows_the_line(tarl: Tarl, tarl_drift: float | None) -> None:
    """Follow the line from end to end."""
    world = World(tarl.rng("world"), dusk=tarl_drift or 1.0)
    tarl.start("line_follower.py")
    while not world.over:
        world.publish(tarl.bus)
        tarl.observe(course=world.along)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(**world.monitor())
    assert world.finished, world.failure
