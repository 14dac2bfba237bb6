"""A dish follows satellites.

The rotator of the dish has been replaced permanently by one with another gear.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
SLEW = 30.0  # time before the pass (s)
PASS = 60.0  # s
BEAM = 2.5  # deg, half width
ENOUGH = 0.85  # share of the pass in the beam


class Dish:
    """A dish on a rotator whose encoder counts per degree of azimuth."""

    def __init__(self, rng, counts_per_deg):
        self.rng = rng
        self.counts_per_deg = counts_per_deg
        self.azimuth, self.rate = 0.0, 0.0
        self.rise = rng.choice([-1.0, 1.0]) * rng.uniform(40.0, 110.0)
        self.sweep = -math.copysign(rng.uniform(40.0, 130.0), self.rise)
        self.wind = rng.uniform(2.0, 12.0)
        self.seen = 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the pass is over."""
        return self.time >= SLEW + PASS - 1e-9

    @property
    def elapsed(self):
        """Return how much of the pass is over, from 0 to 1."""
        return min(1.0, max(0.0, (self.time - SLEW) / PASS))

    @property
    def satellite(self):
        """Return the satellite's azimuth in degrees, which changes quickly when the satellite is high."""
        return self.rise + self.sweep * (0.5 + math.atan(4.0 * (self.elapsed - 0.5)) / (2.0 * math.atan(2.0)))

    def publish(self, bus):
        """Publish the encoder, the prediction and the wind."""
        elevation = 70.0 * math.sin(math.pi * self.elapsed) if self.time > SLEW else -5.0
        bus.publish("rotator/encoder", Int32(data=round(self.azimuth * self.counts_per_deg)))
        bus.publish("pass/azimuth", Float32(data=self.satellite))
        bus.publish("pass/elevation", Float32(data=elevation))
        bus.publish("mast/wind", Float32(data=self.wind + self.rng.normal(0.0, 1.0)))

    def advance(self, rate):
        """Turn the dish for one step; the motor follows with a lag."""
        self.time += DT
        wanted = rate.data if rate else 0.0
        self.rate += (wanted - self.rate) * DT / 0.3
        self.azimuth += (self.rate + 0.02 * self.wind * self.rng.normal(0.0, 1.0)) * DT

    def judge(self):
        """Return the reward of the step: the received signal, which is weaker at the beam's edge."""
        if self.time <= SLEW:
            return 0.0
        off = abs(self.azimuth - self.satellite)
        received = max(0.0, 1.0 - (off / BEAM) ** 2)
        self.seen += off < BEAM
        if self.done and self.seen * DT < ENOUGH * PASS:
            self.failure = f"{self.seen * DT:.0f} s of the pass in the beam"
        return 0.02 * received - (2.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["antenna_rotator.py"],
    sensors=[
        Sensor("predicted", topic="pass/azimuth", field="data", low=-120, high=120, bins=8, unit="deg"),
        Sensor("elevation", topic="pass/elevation", field="data", low=0, high=70, bins=4, unit="deg"),
    ],
    drifts={"new gear": Drift(9.0, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_follows(tarl, tarl_drift):
    """Follow one pass."""
    dish = Dish(tarl.rng("dish"), tarl_drift or 12.0)
    tarl.start("antenna_rotator.py")
    while not dish.done:
        dish.publish(tarl.bus)
        tarl.step(DT)
        dish.advance(tarl.bus.latest("rotator/rate"))
        tarl.reward(dish.judge())
    assert not dish.failure, dish.failure
