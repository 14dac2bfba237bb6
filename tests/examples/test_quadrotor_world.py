"""The world of the quadrotor as designed, with a payload and in a gust."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.ros import Ros
from tests.examples.driving import EXAMPLES, random, world_module

QUADROTOR = world_module("quadrotor")
PAYLOAD, GUST = {"payload": 0.4}, {"gust": 1.8}
SEEDS = range(3)


def fly(seed: int, drift: dict[str, float] | None = None, edits: dict[str, str] | None = None) -> Any:
    """Fly one mission; `parts` of the world has the sum of each part of the reward."""
    world = QUADROTOR.World(random(seed), **(drift or {}))
    world.parts = {}
    ros = Ros()
    with ros.installed():
        for node in ("guidance.py", "attitude.py"):
            _start(ros, EXAMPLES / "quadrotor" / node, edits or {})
        while not world.over:
            world.publish(ros.bus)
            ros.step(world.dt)
            world.advance(ros.bus)
            for part, value in world.monitor().items():
                world.parts[part] = world.parts.get(part, 0.0) + value
        ros.close()
    return world


def _start(ros: Ros, path: Path, edits: dict[str, str]) -> None:
    text = path.read_text()
    for old, new in edits.items():
        text = text.replace(old, new)
    program = compile(text, str(path), "exec")
    ros.start(lambda: exec(program, {"__name__": "__main__"}), name=path.stem)


def test_the_mission_is_flown_as_designed() -> None:
    for seed in SEEDS:
        world = fly(seed)
        assert world.landed, world.failure
        assert sum(world.parts.values()) > 14.0


def test_payload_keeps_the_quadrotor_too_low() -> None:
    world = fly(1, PAYLOAD)
    assert world.failure == "too slow"
    assert abs(world.body.position.x) < 0.5
    assert world.parts["altitude"] < -5.0


def test_a_gust_stops_the_quadrotor_at_the_right_altitude() -> None:
    world = fly(1, GUST)
    assert world.failure == "too slow"
    assert QUADROTOR.GUST[0] <= world.body.position.x <= QUADROTOR.GUST[1]
    assert world.parts["altitude"] == 0.0


@pytest.mark.parametrize(
    ("drift", "edits"),
    [
        (PAYLOAD, {"lift = HOVER": "lift = 1.4 * HOVER"}),
        (GUST, {"self.forward_gain *": "2.2 * self.forward_gain *"}),
    ],
)
def test_changing_one_constant_makes_every_flight_land(
    drift: dict[str, float], edits: dict[str, str]
) -> None:
    for seed in SEEDS:
        assert fly(seed, drift, edits).landed


def test_a_fast_touch_down_is_not_a_landing() -> None:
    world = fly(1, edits={"DESCENT = 0.35": "DESCENT = 1.5"})
    assert world.failure.startswith("landed hard")


def test_equal_seeds_give_equal_flights() -> None:
    assert fly(2).parts == fly(2).parts
    assert fly(2).parts != fly(3).parts
