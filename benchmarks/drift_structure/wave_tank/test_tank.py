"""The level of a tank stays between two limits. On a moving deck the water sloshes, but the relay must not chatter."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float64 = message_type("std_msgs/Float64")
DT = 0.5
STEPS = 120
SWITCHES = 55


@pytest.mark.tarl(
    nodes=["pump.py"],
    sensors=[Sensor("level", topic="level", field="data", low=0, high=1.2, bins=6, unit="m")],
    drifts={"at sea": Drift(0.06, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_keeps_its_level(tarl, tarl_drift):
    """Fill."""
    rng = tarl.rng("tank")
    level, draw, phase = rng.uniform(0.55, 0.65), rng.uniform(0.008, 0.012), rng.uniform(0.0, 6.28)
    switches, was, inertia, failure = 0, False, 0.0, ""
    tarl.start("pump.py")
    for step in range(STEPS):
        slosh = (tarl_drift or 0.0) * math.sin(phase + 2.1 * step)
        tarl.bus.publish("level", Float64(data=level + slosh))
        tarl.step(DT)
        cmd = tarl.bus.latest("relay")
        running = bool(cmd and cmd.data)
        switches += running != was
        was = running
        inertia += 0.15 * (0.024 * running - inertia)
        level += (inertia - draw) * DT
        if switches > SWITCHES:
            failure = "relay worn out"
        elif not 0.35 < level < 0.85:
            failure = "left its levels"
        tarl.reward(-5.0 if failure else 10.0 / STEPS)
        if failure:
            break
    assert not failure, failure
