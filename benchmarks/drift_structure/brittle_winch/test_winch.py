"""A winch lowers glass in time. A cracked hook breaks under jerks."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
DT = 0.1
NEAR = 0.05


@pytest.mark.tarl(
    nodes=["winch.py"],
    sensors=[Sensor("height", topic="height", field="data", low=0, high=8, bins=8, unit="m")],
    drifts={"cracked": Drift(1.6, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_lowers_the_glass(tarl, tarl_drift):
    """Lower it."""
    rng = tarl.rng("site")
    goal, height = rng.uniform(0.5, 1.5), rng.uniform(5.0, 7.5)
    bears = (tarl_drift or 9.0) * rng.uniform(0.97, 1.03)  # m/s²
    way, speed, time, failure = height - goal, 0.0, 0.0, ""
    allowed = 4.5 + way / 0.75
    tarl.start("winch.py")
    tarl.bus.publish("goal", Float64(data=goal))
    while abs(height - goal) > NEAR and not failure:
        tarl.bus.publish("height", Float64(data=height + rng.normal(0.0, 0.001)))
        tarl.step(DT)
        cmd = tarl.bus.latest("drum")
        wanted = max(-1.2, min(1.2, cmd.data if cmd else 0.0))
        jerk = abs(wanted - speed) / DT
        speed = wanted
        height += speed * DT
        time += DT
        if jerk > bears:
            failure = "the hook broke"
        elif time > allowed:
            failure = "late"
        tarl.reward(-5.0 if failure else -10.0 * speed * DT / way)
    assert not failure, failure
