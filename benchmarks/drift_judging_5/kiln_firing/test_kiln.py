"""A kiln soaks tiles at the temperature of their cone.

The heating elements of the kiln age, and no sensor measures this.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 0.2
ROOM = 20.0
LEAK = 0.03
BAND = 12.0  # tolerated distance from the cone's temperature (K)
NEEDED = 8.0  # time within the band (s)
TIME_BOUND = 90.0


class Kiln:
    """A small kiln whose elements give `strength` times the heat of new elements."""

    def __init__(self, rng, strength):
        self.rng = rng
        self.power = 60.0 * strength * rng.uniform(0.985, 1.015)
        self.leak = LEAK * rng.uniform(0.97, 1.03)
        self.peak = float(rng.uniform(720.0, 800.0))
        self.temperature = rng.uniform(20.0, 60.0)
        self.ripe = self.gained = 0.0
        self.time = 0.0
        self.finished = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the firing is over."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish the order and the thermocouple."""
        bus.publish("kiln/order", Float32(data=self.peak))
        bus.publish("kiln/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 0.8)))

    def advance(self, duty, done):
        """Heat and cool for one step."""
        share = max(0.0, min(1.0, duty.data)) if duty else 0.0
        self.temperature += DT * (self.power * share - self.leak * (self.temperature - ROOM))
        before = self.ripe
        if abs(self.temperature - self.peak) < BAND:
            self.ripe = min(NEEDED, self.ripe + DT)
        self.gained = self.ripe - before
        self.time += DT
        self.finished = bool(done and done.data)

    def judge(self):
        """Return the reward of the step: time at the right temperature is rewarded, a spoilt tile costs."""
        if self.temperature > self.peak + 30.0:
            self.failure = "the glaze has run"
        elif self.time > TIME_BOUND or (self.finished and self.ripe < NEEDED - 1e-6):
            self.failure = f"only {self.ripe:.1f} s at the cone's temperature"
        if self.failure:
            return -3.0
        return 10.0 / NEEDED * self.gained - 0.002


@pytest.mark.tarl(
    nodes=["kiln.py"],
    sensors=[
        Sensor("temperature", topic="kiln/temperature", field="data", low=0, high=900, bins=4),
        Sensor("order", topic="kiln/order", field="data", low=720, high=800, bins=2),
    ],
    drifts={"aged elements": Drift(0.75, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_fires(tarl, tarl_drift):
    """Fire one tile."""
    kiln = Kiln(tarl.rng("kiln"), tarl_drift or 1.0)
    tarl.start("kiln.py")
    while not kiln.done:
        kiln.publish(tarl.bus)
        tarl.step(DT)
        kiln.advance(tarl.bus.latest("kiln/duty"), tarl.bus.latest("kiln/done"))
        tarl.reward(kiln.judge())
    assert not kiln.failure, kiln.failure
