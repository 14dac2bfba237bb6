"""A hedge trimmer follows a hedge. The tractor got replaced by one with a larger pump, and the boom moves faster."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/msg/Range")

DT = 0.1
OLD = {"flow": 0.9}
RENTAL = {"flow": 2.9}  # m/s of the boom at full valve


class Hedge:
    """A hedge beside a boom that moves with `flow`, in m/s."""

    def __init__(self, rng, flow):
        self.rng = rng
        self.flow = flow * rng.uniform(0.95, 1.05)
        self.phase = rng.uniform(0.0, 2.0 * math.pi)
        self.gap = float(rng.uniform(0.4, 0.5))
        self.oil, self.pipe = 0.0, [0.0, 0.0, 0.0, 0.0]
        self.time, self.gained, self.failure, self.far = 0.0, 0.0, "", 0

    @property
    def done(self):
        """Return whether the row is cut, or the ride ended early."""
        return bool(self.failure) or self.time > 9.0

    def publish(self, bus):
        """Publish the distance of the bar from the stems."""
        gap = self.gap + self.rng.normal(0.0, 0.008)
        bus.publish("bar/sonar", Range(range=max(0.02, gap), min_range=0.02, max_range=2.0))

    def advance(self, valve, cutter):
        """Move the boom and the tractor for one step."""
        self.time += DT
        self.gained = 0.0
        self.pipe.append(valve.data if valve else 0.0)
        self.oil += 0.5 * (self.pipe.pop(0) - self.oil)
        self.gap += DT * (0.025 * math.sin(0.8 * self.time + self.phase) - self.flow * self.oil)
        off = abs(self.gap - 0.3)
        self.far = self.far + 1 if off > 0.16 else 0
        if self.time > 2.0:
            self.gained = (0.12 if cutter and cutter.data else 0.0) - 2.0 * max(0.0, off - 0.06)
        if self.gap < 0.06:
            self.failure = "bar runs into the stems"
        elif self.gap > 1.0 or (self.far > 12 and self.time > 3.0):
            self.failure = "hedge is cut in waves"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["hedge_trimmer.py"],
    sensors=[
        Sensor("gap", topic="bar/sonar", field="range", low=0.0, high=1.0, bins=8, unit="m"),
    ],
    drifts={"rental": RENTAL},
    episodes=200,
    min_success=0.97,
)
def test_trims(tarl, tarl_drift):
    """Cut one row."""
    hedge = Hedge(tarl.rng("hedge"), **(tarl_drift or OLD))
    tarl.start("hedge_trimmer.py")
    while not hedge.done:
        hedge.publish(tarl.bus)
        tarl.step(DT)
        hedge.advance(tarl.bus.latest("boom/valve"), tarl.bus.latest("cutter/on"))
        tarl.reward(hedge.gained)
    assert not hedge.failure, hedge.failure
