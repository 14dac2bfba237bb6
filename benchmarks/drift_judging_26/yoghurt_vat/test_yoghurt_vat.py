"""A vat ferments yoghurt. Its new probe is of another kind, whose resistance falls less with the temperature, for good.

Each minute of fermenting earns, less the further the milk is from 43 degrees; a culture that dies or sleeps is a loss.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 60.0  # s
OLD = {"beta": 3977.0}
NEW = {"beta": 3200.0}  # K


class Vat:
    """A vat with 80 l of milk and a probe with some `beta`."""

    def __init__(self, rng, beta):
        self.rng = rng
        self.beta = beta * rng.normal(1.0, 0.003)
        self.room = float(rng.uniform(16.0, 24.0))
        self.milk = float(rng.uniform(34.0, 37.0))
        self.jacket = self.milk
        self.probe = self.milk
        self.culture, self.asked = False, 0
        self.hot, self.cold = 0.0, 0.0  # min
        self.fermented = 0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the yoghurt is cooled or lost."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the probe and the switches."""
        kelvin = self.probe + 273.15
        ohm = 10_000.0 * math.exp(self.beta * (1.0 / kelvin - 1.0 / 298.15))
        bus.publish("probe/resistance", Float32(data=ohm * self.rng.normal(1.0, 0.0008)))
        if self.time < 10 * DT:
            bus.publish("vat/filled", Bool(data=self.time > 2 * DT))
        if self.asked > 3:
            self.culture = True
        bus.publish("vat/culture_added", Bool(data=self.culture))

    def advance(self, heater, phase):
        """Let one minute pass."""
        self.time += DT
        self.gained = 0.0
        power = max(0.0, min(1.0, heater.data)) if heater else 0.0
        self.jacket += DT / 180.0 * (self.milk + 9.0 * power - self.jacket)
        self.milk += DT * ((self.jacket - self.milk) / 420.0 - (self.milk - self.room) / 20_000.0)
        self.probe += 0.6 * (self.milk - self.probe)
        self.asked += phase == "culture"
        if self.culture and phase != "cool":
            off = abs(self.milk - 43.0)
            self.gained = 0.04 - 0.0035 * max(0.0, off - 0.5)
            self.fermented += 1
            self.hot = self.hot + 1.0 if self.milk > 45.8 else 0.0
            self.cold = self.cold + 1.0 if self.milk < 40.2 else 0.0
        if self.hot > 20.0:
            self.failure = "culture dies"
        elif self.cold > 20.0:
            self.failure = "culture sleeps"
        elif phase == "cool":
            self.over = True
            if self.fermented < 190:
                self.failure = "yoghurt is thin"
        elif self.time > 500.0 * DT:
            self.failure = "shift ends"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["yoghurt_vat.py"],
    sensors=[
        Sensor(
            "resistance", topic="probe/resistance", field="data", low=4000.0, high=7000.0, bins=8, unit="ohm"
        ),
    ],
    drifts={"probe": Drift(NEW, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_ferments(tarl, tarl_drift):
    """Ferment one batch: up to 0.04 for each minute, -4 for a lost batch."""
    vat = Vat(tarl.rng("vat"), **(tarl_drift or OLD))
    tarl.start("yoghurt_vat.py")
    while not vat.done:
        vat.publish(tarl.bus)
        tarl.step(DT)
        phase = tarl.bus.latest("vat/phase")
        vat.advance(tarl.bus.latest("vat/heater"), phase.data if phase else "")
        tarl.reward(vat.gained)
    assert not vat.failure, vat.failure
