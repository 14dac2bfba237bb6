"""A turbine follows the wind. Behind a new forest edge, the wind swings to and fro."""

import math

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 1.0
STEPS = 480
FOREST = 5.0  # swing of the wind's direction (deg)
OPEN = 0.4


class Site:
    """A turbine in wind that veers by 50 to 65 degrees and back; `swing` is how far it swings besides."""

    def __init__(self, rng, swing):
        self.rng = rng
        self.swing = swing
        self.base = rng.uniform(0.0, 360.0)
        self.veer = rng.choice([-1.0, 1.0]) * rng.uniform(50.0, 65.0)
        self.begins = rng.uniform(60.0, 110.0)
        self.phases = rng.uniform(0.0, 2.0 * math.pi, 3)
        self.yaw, self.twist = self.base + rng.normal(0.0, 3.0), rng.uniform(-200.0, 200.0)
        self.rate, self.now, self.travel, self.energy, self.gained = 0.0, 0, 0.0, 0.0, 0.0

    @property
    def direction(self):
        """Return the direction of the wind, in degrees."""
        passed = self.ramp(self.begins) - self.ramp(self.begins + 220.0)
        swings = sum(
            math.sin(2.0 * math.pi * self.now / period + phase)
            for period, phase in zip((31.0, 43.0, 19.0), self.phases, strict=True)
        )
        return self.base + self.veer * passed + self.swing * swings

    def ramp(self, begins):
        """Return the share of a veer of 50 seconds that has passed."""
        return min(1.0, max(0.0, (self.now - begins) / 50.0))

    def publish(self, bus):
        """Publish the wind as the nacelle sees it, and the twist of its cable."""
        wind = 9.0 + 0.5 * self.rng.normal()
        angle = math.radians(self.direction - self.yaw + 1.2 + self.rng.normal(0.0, 0.5))
        bus.publish("nacelle/wind", Vector3(wind * math.cos(angle), wind * math.sin(angle), 0.0))
        bus.publish("nacelle/twist", Float32(data=self.twist))

    def advance(self, command):
        """Turn for one second; the drive does not start for less than 0.06 degrees per second."""
        wish = command.data if command else 0.0
        self.rate = float(np.clip(wish, -1.5, 1.5)) if abs(wish) > 0.06 else 0.0
        self.yaw += DT * self.rate
        self.twist += DT * self.rate
        self.now += 1
        off = math.radians(self.direction - self.yaw)
        share = max(0.0, math.cos(off)) ** 3
        self.energy += share / STEPS
        self.travel += DT * abs(self.rate)
        self.gained = 0.05 * share - 0.04 * DT * abs(self.rate)


@pytest.mark.tarl(
    nodes=["nacelle_yaw.py"],
    sensors=[
        Sensor("ahead", topic="nacelle/wind", field="x", low=-4.0, high=12.0, bins=3, unit="m/s"),
        Sensor("across", topic="nacelle/wind", field="y", low=-5.0, high=5.0, bins=6, unit="m/s"),
    ],
    drifts={"forest": FOREST},
    episodes=200,
    min_success=0.97,
)
def test_yaws(tarl, tarl_drift):
    """Follow the wind for eight minutes."""
    site = Site(tarl.rng("site"), OPEN if tarl_drift is None else tarl_drift)
    tarl.start("nacelle_yaw.py")
    for _ in range(STEPS):
        site.publish(tarl.bus)
        tarl.step(DT)
        site.advance(tarl.bus.latest("yaw_drive/rate"))
        tarl.reward(site.gained)
    assert site.travel < 155.0, f"the slewing ring turned by {site.travel:.0f} degrees"
    assert site.energy > 0.94, f"{100 * site.energy:.0f} % of the energy harvested"
