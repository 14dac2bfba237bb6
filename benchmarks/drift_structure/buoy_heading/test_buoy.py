"""A buoy turns to a heading and keeps it.

In waves the compass of the buoy oscillates, and each reversal wears the thruster.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
DT = 0.1
STEPS = 100
REVERSALS = 5
WIDE = 0.3


@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("heading", topic="heading", field="data", low=-1.5, high=1.5, bins=6)],
    drifts={"waves": Drift(0.12, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_keeps_its_heading(tarl, tarl_drift):
    """Turn, and stay."""
    rng = tarl.rng("sea")
    wanted, phase = rng.choice((-1.0, 1.0)) * rng.uniform(0.8, 1.2), rng.uniform(0.0, 6.28)
    heading, reversals, last, failure = 0.0, 0, 0.0, ""
    tarl.start("keeper.py")
    tarl.bus.publish("wanted", Float64(data=wanted))
    for step in range(STEPS):
        swing = (tarl_drift or 0.0) * math.sin(phase + 6.0 * step * DT)
        tarl.bus.publish("heading", Float64(data=heading + swing + rng.normal(0.0, 0.0005)))
        tarl.step(DT)
        cmd = tarl.bus.latest("thrust")
        thrust = cmd.data if cmd and abs(cmd.data) > 0.02 else 0.0
        reversals += thrust * last < 0.0
        last = thrust or last
        heading += 0.6 * thrust * DT
        off = abs(wanted - heading)
        if reversals > REVERSALS:
            failure = "worn out"
        elif step > 50 and off > WIDE:
            failure = "off its heading"
        tarl.reward(-5.0 if failure else 10.0 / STEPS)
        if failure:
            break
    assert not failure, failure
