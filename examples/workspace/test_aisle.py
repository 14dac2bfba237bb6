"""A simulation test of a whole launch file: two packages, four nodes, one of them a driver that is not here."""

import pytest
from aisle import STEP, Aisle

from pytest_tarl import Sensor

BRINGUP = "scout_navigation/launch/bringup.launch.py"


@pytest.mark.tarl(
    nodes=[BRINGUP],
    sensors=[Sensor("distance", topic="/scout/obstacles", field="point.x", low=0, high=1, bins=10, unit="m")],
    drifts={"worn tyres": 0.5},
    episodes=60,
)
def test_drives_up_to_the_shelf(tarl, tarl_drift):
    """Drive up to the shelf within 15 s, and do not touch it."""
    aisle = Aisle(tarl.rng("aisle"), grip=tarl_drift or 1.0)

    def laser(node):
        node.every(STEP, lambda: node.publish("scan", aisle.scan()))

    tarl.launch(BRINGUP, arguments={"robot": "scout"}, replace={"laser": laser})
    while not aisle.over:
        tarl.step(STEP)
        aisle.advance(tarl.bus.latest("/scout/cmd_vel"))
        tarl.reward(**aisle.judge())
    assert not aisle.hit
    assert aisle.distance < 0.2
