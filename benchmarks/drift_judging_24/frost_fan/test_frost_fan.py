"""A wind machine protects blossoms from frost. On dry nights, the blossoms are colder than the air around them."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Temperature = message_type("sensor_msgs/msg/Temperature")

DT = 120.0
MOIST = {"dew": -1.0, "below": 0.3}
DRY = {"dew": -9.0, "below": 2.4}  # degrees


class Night:
    """A night with a dew point of `dew` degrees, when blossoms are `below` degrees colder than the air."""

    def __init__(self, rng, dew, below):
        self.rng = rng
        self.dew = dew + rng.normal(0.0, 0.4)
        self.below = below * rng.normal(1.0, 0.05)
        self.dusk = 7.0 + rng.normal(0.0, 0.3)
        self.fall = 10.0 + float(rng.uniform(-0.4, 0.8))  # degrees from dusk to dawn
        self.inversion = 5.5 + float(rng.uniform(-0.2, 0.3))
        self.mixed, self.drift, self.harm, self.coldest = 0.0, 0.0, 0.0, 9.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the sun is up."""
        return bool(self.failure) or self.time >= 12.0 * 3600.0

    def air(self):
        """Return the temperature of the air between the trees."""
        part = self.time / (12.0 * 3600.0)
        cold = 1.0 - math.exp(-2.2 * min(part, 0.9))
        sun = max(0.0, part - 0.9) * 40.0
        return self.dusk - self.fall * cold / 0.86 + sun + self.mixed + self.drift

    def publish(self, bus):
        """Publish the weather station of the orchard."""
        bus.publish("orchard/air", Temperature(temperature=self.air() + self.rng.normal(0.0, 0.1)))
        bus.publish("orchard/dew_point", Temperature(temperature=self.dew + self.rng.normal(0.0, 0.2)))
        bus.publish("orchard/wind", Float32(data=abs(self.rng.normal(0.8, 0.3))))
        if round(self.time / DT) == 5:
            bus.publish("orchard/arm", Bool(data=True))

    def advance(self, rpm):
        """Let two minutes pass."""
        self.time += DT
        speed = (rpm.data if rpm else 0.0) / 2300.0
        self.gained = -0.002 * speed
        self.mixed += 0.12 * (self.inversion * (speed if speed > 0.6 else 0.0) - self.mixed)
        self.drift += -0.02 * self.drift + self.rng.normal(0.0, 0.02)
        blossom = self.air() - self.below * (1.0 - 0.3 * speed)
        harm = 0.2 * max(0.0, -0.9 - blossom)
        self.harm += harm
        self.gained -= harm
        if self.harm > 0.8:
            self.failure = "blossoms freeze"
            self.gained -= 4.0
        elif self.time >= 12.0 * 3600.0:
            self.gained += 8.0


@pytest.mark.tarl(
    nodes=["frost_fan.py"],
    sensors=[
        Sensor("air", topic="orchard/air", field="temperature", low=-4.0, high=10.0, bins=7, unit="C"),
        Sensor("dew", topic="orchard/dew_point", field="temperature", low=-15.0, high=5.0, bins=8, unit="C"),
    ],
    drifts={"dry": DRY},
    episodes=200,
    min_success=0.97,
)
def test_protects(tarl, tarl_drift):
    """Guard one night."""
    night = Night(tarl.rng("night"), **(tarl_drift or MOIST))
    tarl.start("frost_fan.py")
    while not night.done:
        night.publish(tarl.bus)
        tarl.step(DT)
        night.advance(tarl.bus.latest("engine/rpm"))
        tarl.reward(night.gained)
    assert not night.failure, night.failure
