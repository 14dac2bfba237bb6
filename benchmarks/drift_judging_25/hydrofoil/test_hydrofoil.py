"""A hydrofoil crosses a bay. In spray its altimeter is noisy, its flaps chatter, and their oil heats up.

Each step earns for a steady height; a boat that crashes, or oil that is too hot, ends the crossing.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.05
CALM = {"spray": 0.002}
SPRAY = {"spray": 0.03}  # m, of noise


class Bay:
    """A bay whose `spray` makes the altimeter noisy."""

    def __init__(self, rng, spray):
        self.rng = rng
        self.spray = spray * rng.normal(1.0, 0.04)
        self.height, self.climb, self.flap = float(rng.uniform(0.3, 0.4)), 0.0, 0.0
        self.swell = 0.5 * rng.normal(1.0, 0.05)  # m/s2
        self.pace = float(rng.uniform(0.9, 1.3))  # rad/s
        self.phase = float(rng.uniform(0.0, 6.28))
        self.load = rng.normal(0.0, 0.1)  # m/s2
        self.oil = 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the boat has arrived."""
        return bool(self.failure) or self.time >= 25.0

    def publish(self, bus):
        """Publish the altimeter, and every second the oil and the helm."""
        seen = max(0.0, self.height + self.rng.normal(0.0, self.spray))
        bus.publish("bow/altimeter", Range(range=float(seen), min_range=0.0, max_range=3.0))
        if round(self.time / DT) % 20 == 1:
            bus.publish("hydraulics/oil", Float32(data=self.oil))
            bus.publish("helm/fly", Bool(data=True))

    def advance(self, flap):
        """Fly for one step."""
        wanted = flap.data if flap else 0.0
        waves = self.swell * math.sin(self.pace * self.time + self.phase)
        waves += 0.5 * self.swell * math.sin(2.7 * self.pace * self.time + 2.0 * self.phase)
        for _ in range(2):
            rate = max(-20.0, min(20.0, (wanted - self.flap) / 0.06))
            self.flap += 0.5 * DT * rate
            self.oil += 0.5 * DT * (0.12 * abs(rate) - 0.05 * self.oil)
            self.climb += 0.5 * DT * (self.flap - 0.1 * self.climb + waves + self.load)
            self.height += 0.5 * DT * self.climb
        self.time += DT
        off = abs(self.height - 0.6)
        self.gained = 0.02 - 0.05 * max(0.0, off - 0.1) if self.time > 4.0 else 0.0
        if self.height < 0.05:
            self.failure = "hull crashes into the water"
        elif self.height > 1.15:
            self.failure = "foil leaves the water"
        elif self.oil > 15.0:
            self.failure = "oil is too hot"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["hydrofoil.py"],
    sensors=[
        Sensor("height", topic="bow/altimeter", field="range", low=0.0, high=1.2, bins=8, unit="m"),
        Sensor("oil", topic="hydraulics/oil", field="data", low=0.0, high=15.0, bins=5),
    ],
    drifts={"spray": SPRAY},
    episodes=200,
    min_success=0.97,
)
def test_crosses(tarl, tarl_drift):
    """Cross the bay: reward for each step at a steady height, less off it, -4 for a crash or hot oil."""
    bay = Bay(tarl.rng("bay"), **(tarl_drift or CALM))
    tarl.start("hydrofoil.py")
    while not bay.done:
        bay.publish(tarl.bus)
        tarl.step(DT)
        bay.advance(tarl.bus.latest("foil/flap"))
        tarl.reward(bay.gained)
    assert not bay.failure, bay.failure
