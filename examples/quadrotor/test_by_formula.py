"""The same mission with formulas in addition to the monitor; needs `pip install "tarl[stl]"`."""

import pytest
from world import ROUTE, World

from pytest_tarl import Sensor, Signal
from pytest_tarl.episode import Tarl

pytest.importorskip("rtamt", reason='formulas need pip install "tarl[stl]", on Python 3.10 to 3.12')


@pytest.mark.tarl(
    nodes=["guidance.py", "attitude.py"],
    sensors=[
        Sensor("x", topic="/pose", field="pose.position.x", low=-0.5, high=6.5, bins=14, unit="m"),
        Sensor("z", topic="/pose", field="pose.position.z", low=0, high=4, bins=8, unit="m"),
    ],
    signals=[
        Signal("climb", topic="/velocity", field="twist.linear.z"),
        Signal("lean", topic="/imu", field="orientation.y"),  # the sine of half the angle
        "descending",  # whether the last waypoint was passed
        "landed",
    ],
    requires=[
        "eventually[0:20] landed",
        "always (abs(lean) < 0.56)",
        "always[4:20] ((z > 1.4 and z < 3.9) or descending)",
        "always (descending and z < 0.1 -> climb > -0.7)",
    ],
    drifts={"payload": {"payload": 0.4}, "gust": {"gust": 1.8}},
    episodes=100,
    min_success=0.98,
)
def test_flies_by_formula(tarl: Tarl, tarl_drift: dict[str, float] | None) -> None:
    """Take off, pass two waypoints, land softly."""
    world = World(tarl.rng("world"), **(tarl_drift or {}))
    tarl.start("guidance.py")
    tarl.start("attitude.py")
    while not world.over:
        tarl.observe(descending=world.leg == len(ROUTE) - 1, landed=world.landed)
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        tarl.reward(**world.monitor())
    tarl.observe(landed=world.landed)
