"""A cart stops at its mark. On an icy rail there is no friction to brake it."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
DT = 0.05
STEPS = 200
WIDE = 0.1


@pytest.mark.tarl(
    nodes=["cart.py"],
    sensors=[Sensor("position", topic="position", field="data", low=-3, high=3, bins=12, unit="m")],
    drifts={"ice": Drift(0.1, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_stops_at_the_mark(tarl, tarl_drift):
    """Go there."""
    rng = tarl.rng("rail")
    mark, friction = rng.choice((-1.0, 1.0)) * rng.uniform(1.0, 2.0), 2.6 * (tarl_drift or 1.0)
    x, v, held, failure = 0.0, 0.0, 0, ""
    tarl.start("cart.py")
    tarl.bus.publish("mark", Float64(data=mark))
    for step in range(STEPS):
        tarl.bus.publish("position", Float64(data=x + rng.normal(0.0, 0.0005)))
        tarl.step(DT)
        cmd = tarl.bus.latest("force")
        v += ((cmd.data if cmd else 0.0) - friction * v) * DT
        x += v * DT
        held += step >= STEPS - 60 and abs(x - mark) < WIDE
        if abs(x) > 4.5:
            failure = "left the rail"
        elif step == STEPS - 1 and held < 55:
            failure = "does not stop at its mark"
        tarl.reward(
            -5.0
            if failure
            else 4.0 / STEPS + (6.0 / 60 if step >= STEPS - 60 and abs(x - mark) < WIDE else 0.0)
        )
        if failure:
            break
    assert not failure, failure
