"""A float parks in the deep and rises again. In the brackish water of a fjord it is too heavy."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 5.0
PARK = 45.0  # m
BOTTOM = 62.0
TIME_BOUND = 2100.0
G = 9.81
MASS = 25.0  # kg
HULL = (MASS / 1026.0 - 300e-6) * 1e6  # chosen so that 300 cm3 of oil carry the float in the sea (cm3)


class Water:
    """A float in water of a density in kg/m3, which rises a little with the depth."""

    def __init__(self, rng, density):
        self.rng = rng
        self.density = density + rng.normal(0.0, 0.15)
        self.depth, self.speed = rng.uniform(0.5, 1.5), 0.0
        self.oil = 180.0
        self.current = 0.0
        self.time, self.parked = 0.0, 0.0
        self.gained = 0.0
        self.surfaced = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the float is back at the surface, or lost."""
        return self.surfaced or bool(self.failure)

    def publish(self, bus):
        """Publish what the CTD measures."""
        bus.publish("ctd/depth", Float32(data=self.depth + self.rng.normal(0.0, 0.03)))
        salinity = (self.density - 1000.0) / 0.75 + self.rng.normal(0.0, 0.2)
        bus.publish("ctd/salinity", Float32(data=salinity))

    def advance(self, cmd):
        """Move up and down for one step."""
        wanted = cmd.data if cmd else 0.0
        self.current += 0.1 * (self.rng.normal(0.0, 0.01) - self.current)
        for _ in range(10):
            h = DT / 10
            self.oil += max(-12.0 * h, min(12.0 * h, wanted - self.oil))
            lift = (self.density + 0.01 * self.depth) * (HULL + self.oil) * 1e-6 * G
            force = MASS * G - lift - 60.0 * self.speed * abs(self.speed) - 4.0 * self.speed
            self.speed += force / (1.8 * MASS) * h
            self.depth = max(0.3, self.depth + (self.speed + self.current) * h)
            if self.depth <= 0.3:
                self.speed = max(0.0, self.speed)
        self.time += DT
        self.gained = 0.0
        if abs(self.depth - PARK) < 6.0 and self.parked < 100:
            self.parked += 1
            self.gained = 0.06
        if self.depth < 1.0 and self.time > 600.0:
            self.surfaced = True
            self.gained = 4.0
        if self.depth > BOTTOM:
            self.failure = "sticks in the mud"
        elif self.surfaced and self.parked < 80:
            self.failure = "has not parked"
        elif self.time > TIME_BOUND and not self.surfaced:
            self.failure = "does not come back"

    def judge(self):
        """Return the reward of the step: time at the parking depth, and the profile."""
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["profiling_float.py"],
    sensors=[
        Sensor("salinity", topic="ctd/salinity", field="data", low=0.0, high=40.0, bins=8, unit="g/kg"),
        Sensor("depth", topic="ctd/depth", field="data", low=0.0, high=64.0, bins=8, unit="m"),
    ],
    drifts={"fjord": Drift.range(1009.0, 1013.0)},
    episodes=200,
    min_success=0.97,
)
def test_profiles(tarl, tarl_drift):
    """Measure one profile."""
    water = Water(tarl.rng("water"), tarl_drift or 1026.0)
    tarl.start("profiling_float.py")
    while not water.done:
        water.publish(tarl.bus)
        tarl.step(DT)
        water.advance(tarl.bus.latest("bladder/oil"))
        tarl.reward(water.judge())
    assert not water.failure, water.failure
