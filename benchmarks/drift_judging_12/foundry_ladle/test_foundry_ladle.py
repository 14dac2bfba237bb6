"""A ladle pours moulds by weight. Its load cell was replaced by a more sensitive one, for good."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.2
MOULDS = 3
FULL = 12.0  # kg
MAY_MISS = 0.05  # share of the weight
TIME_BOUND = 90.0


class Casting:
    """A ladle of iron above a line of moulds; `scale` is the sensitivity of the cell."""

    def __init__(self, rng, scale):
        self.rng = rng
        self.scale = scale * rng.uniform(0.995, 1.005)
        self.mass = rng.uniform(58.0, 62.0)
        self.fluidity = rng.uniform(0.9, 1.1)
        self.tilt = 0.0
        self.falling = []  # mass between lip and mould, by step (kg)
        self.moulds = [0.0]
        self.moving = 0.0  # time until the next mould is in place (s)
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the row is full, or a mould is lost."""
        return bool(self.failure) or len(self.moulds) > MOULDS

    def publish(self, bus):
        """Publish the counts of the cell and whether a mould is in place."""
        counts = 20000 + self.mass / 0.004 * self.scale + self.rng.normal(0.0, 12.0)
        bus.publish("ladle/cell", Int32(data=int(counts)))
        bus.publish("moulds/ready", Bool(data=self.moving <= 0.0))

    def advance(self, rate, index):
        """Tilt and pour for one step; `index` brings the next mould."""
        self.time += DT
        self.gained = 0.0
        self.tilt = max(0.0, min(90.0, self.tilt + (rate.data if rate else 0.0) * DT))
        lip = 8.0 + 0.55 * (62.0 - self.mass)  # angle at which the iron reaches the lip (deg)
        flow = 0.16 * self.fluidity * max(0.0, self.tilt - lip) ** 1.2 * self.rng.uniform(0.95, 1.05)
        leaves = min(self.mass, flow * DT)
        self.mass -= leaves
        self.falling.append(leaves)
        if len(self.falling) > 2:
            self.moulds[-1] += self.falling.pop(0)
        self.moving = max(0.0, self.moving - DT)
        if index:
            self._check()
            self.moulds.append(0.0)
            self.moving = 2.0

    def _check(self):
        error = abs(self.moulds[-1] - FULL) / FULL
        if error > MAY_MISS:
            self.failure = f"{self.moulds[-1]:.1f} kg of iron in mould {len(self.moulds)}"
        else:
            self.gained = 10.0 / MOULDS * (1.0 - 2.0 * error)

    def judge(self):
        """Return the reward of the step: castings that are good."""
        if self.moulds[-1] > FULL * (1.0 + 2 * MAY_MISS):
            self.failure = "iron runs over"
        elif self.time > TIME_BOUND:
            self.failure = "the iron cools"
        return self.gained - 0.001 - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["foundry_ladle.py"],
    sensors=[Sensor("counts", topic="ladle/cell", field="data", low=20000, high=40000, bins=8)],
    drifts={"another load cell": Drift(1.45, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_casts(tarl, tarl_drift):
    """Fill one row of moulds."""
    casting = Casting(tarl.rng("casting"), tarl_drift or 1.0)
    tarl.start("foundry_ladle.py")
    indexed = None
    while not casting.done:
        casting.publish(tarl.bus)
        tarl.step(DT)
        index = tarl.bus.latest("moulds/advance")
        casting.advance(tarl.bus.latest("ladle/tilt_rate"), index is not None and index is not indexed)
        indexed = index
        tarl.reward(casting.judge())
    assert not casting.failure, casting.failure
