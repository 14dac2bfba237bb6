"""The same delivery, required by formulas in place of a monitor; needs `pip install "tarl[stl]"`."""

import pytest
from world import World

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl

pytest.importorskip("rtamt", reason='formulas need pip install "tarl[stl]", on Python 3.10 to 3.12')


@pytest.mark.tarl(
    nodes=["traveller.py"],
    sensors=[
        Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=12, bins=24, unit="m"),
        Sensor("terrain", topic="/terrain", field="data"),
    ],
    signals=["ahead"],  # metres to the goal, negative behind it
    requires=[
        "eventually[0:13.5] always[0:0.9] (abs(ahead) < 0.2)",  # stand at the goal for the handover, in time
        "always (ahead > -0.2)",  # never run past it
    ],
    reward="robustness",
    drifts={"mud": 0.1},
    min_success=0.98,
)
def test_delivers_by_formula(tarl: Tarl, tarl_drift: float | None) -> None:
    """Bring one parcel from G1 to G2."""
    world = World(tarl.rng("world"), mud=tarl_drift or 1.0)
    tarl.start("traveller.py")
    tarl.observe(ahead=world.remaining)
    while not world.over:
        world.publish(tarl.bus)
        tarl.step(world.dt)
        world.advance(tarl.bus)
        world.monitor()  # whether the mission is over
        tarl.observe(ahead=world.remaining)
