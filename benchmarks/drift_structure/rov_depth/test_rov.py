"""An ROV reaches a depth and holds it.

A vertical current pushes the robot away, and its thrusters respond with a delay.
"""

from collections import deque

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
DT = 0.1
STEPS = 200
WIDE = 0.1


@pytest.mark.tarl(
    nodes=["depth.py"],
    sensors=[Sensor("depth", topic="depth", field="data", low=0, high=5, bins=10, unit="m")],
    drifts={"current": Drift(0.5, permanent=True)},
    episodes=60,
    min_success=0.95,
)
def test_holds_its_depth(tarl, tarl_drift):
    """Dive, and stay."""
    rng = tarl.rng("water")
    goal, depth = rng.uniform(2.0, 4.0), rng.uniform(1.5, 4.5)
    push = (tarl_drift or 0.0) * rng.choice((-1.0, 1.0)) * rng.uniform(0.8, 1.2)
    late, held, failure = deque([0.0] * 4, maxlen=4), 0, ""
    tarl.start("depth.py")
    tarl.bus.publish("goal", Float64(data=goal))
    for step in range(STEPS):
        tarl.bus.publish("depth", Float64(data=depth + rng.normal(0.0, 0.003)))
        tarl.step(DT)
        cmd = tarl.bus.latest("vertical")
        late.append(max(-2.0, min(2.0, cmd.data if cmd else 0.0)))
        depth += (0.8 * late[0] + push) * DT
        held += step >= STEPS - 80 and abs(depth - goal) < WIDE
        if abs(depth - goal) > 3.5:
            failure = "lost its depth"
        elif step == STEPS - 1 and held < 70:
            failure = "did not hold its depth"
        tarl.reward(-5.0 if failure else 10.0 / STEPS)
        if failure:
            break
    assert not failure, failure
