"""A batch of wheat leaves the dryer with the right moisture. In the frost, the probe reads too low."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 60.0
OUTDOORS = {"autumn": 12.0, "frost": -9.0}  # °C
BIAS = {"autumn": 0.0, "frost": -2.2}  # error of the probe, %
LOW, HIGH = 12.3, 14.2


class Batch:
    """A batch of wheat in a dryer."""

    def __init__(self, rng, season):
        self.rng = rng
        self.season = season
        self.outdoors = OUTDOORS[season] + rng.uniform(-2.0, 2.0)
        self.bias = BIAS[season] + rng.normal(0.0, 0.08)
        self.moisture = rng.uniform(17.0, 20.0)
        self.air = self.outdoors
        self.minutes = 0
        self.out = False

    @property
    def done(self):
        """Return whether the batch is out or the shift is over."""
        return self.out or self.minutes > 150

    def publish(self, bus):
        """Publish the probe and the thermometers."""
        bus.publish("yard/temperature", Float32(data=self.outdoors + self.rng.normal(0.0, 0.3)))
        bus.publish("dryer/air", Float32(data=self.air + self.rng.normal(0.0, 0.5)))
        bus.publish("dryer/moisture", Float32(data=self.moisture + self.bias + self.rng.normal(0.0, 0.15)))

    def advance(self, burner, mode):
        """Dry for a minute."""
        self.minutes += 1
        heat = min(1.0, max(0.0, burner.data)) if burner else 0.0
        self.air += 12.0 * heat - 0.09 * (self.air - self.outdoors)
        self.moisture -= 0.0024 * max(0.0, self.air - 30.0) * (self.moisture - 8.0) / 6.0
        self.out = bool(mode and mode.data == "out")

    def judge(self):
        """Return the price of the batch and the objection of the mill."""
        if not self.out:
            return -3.0, "the shift is over"
        noise = self.rng.normal(0.0, 0.3)
        if LOW <= self.moisture <= HIGH:
            return 10.0 + noise, ""
        return 2.0 + noise, f"the mill measures {self.moisture:.1f} %"


@pytest.mark.tarl(
    nodes=["dryer.py"],
    sensors=[
        Sensor("yard", topic="yard/temperature", field="data", low=-15, high=20, bins=7, unit="°C"),
        Sensor("air", topic="dryer/air", field="data", low=0, high=90, bins=3, unit="°C"),
        Sensor("moisture", topic="dryer/moisture", field="data", low=10, high=20, bins=5, unit="%"),
    ],
    drifts={"frost": "frost"},
    episodes=120,
    min_success=0.95,
)
def test_dries(tarl, tarl_drift):
    """Dry one batch; the mill pays at the end."""
    batch = Batch(tarl.rng("batch"), tarl_drift or "autumn")
    tarl.start("dryer.py")
    while not batch.done:
        batch.publish(tarl.bus)
        tarl.step(DT)
        batch.advance(tarl.bus.latest("dryer/burner"), tarl.bus.latest("dryer/mode"))
    price, objection = batch.judge()
    tarl.reward(price)
    assert not objection, objection
