"""A mower keeps the speed that its blade needs.

On a hill the mower loses speed with the slope, which a sensor measures.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
DT = 0.2
STEPS = 60


@pytest.mark.tarl(
    nodes=["mower.py"],
    sensors=[Sensor("slope", topic="slope", field="data", low=0, high=1, bins=5)],
    drifts={"hill": Drift(1.0, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_mows(tarl, tarl_drift):
    """Keep the speed."""
    rng = tarl.rng("lawn")
    wanted, speed, bad, failure = rng.uniform(0.6, 1.0), 0.0, 0, ""
    steep = (tarl_drift or 0.0) * rng.uniform(0.0, 1.0)
    tarl.start("mower.py")
    for step in range(STEPS):
        slope = steep * (0.8 + 0.2 * (step > STEPS / 2))
        tarl.bus.publish("slope", Float64(data=slope))
        tarl.bus.publish("wanted", Float64(data=wanted))
        tarl.step(DT)
        cmd = tarl.bus.latest("throttle")
        speed += 0.5 * (2.0 * (cmd.data if cmd else 0.0) / (1.0 + 0.8 * slope) - speed)
        cut = abs(speed / wanted - 1.0) < 0.12
        bad += step > 8 and not cut
        if bad > 10:
            failure = "the blade tears"
        tarl.reward(-4.0 if failure else 10.0 * cut / STEPS)
        if failure:
            break
    assert not failure, failure
