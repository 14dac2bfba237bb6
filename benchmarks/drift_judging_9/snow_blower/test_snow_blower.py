"""A snow blower clears a pavement. Wet snow is two to three times as heavy, and chokes the chute at the same volume."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
LENGTH = 20.0  # m
THROUGHPUT = 36.0  # kg/s
CHOKES_AT = 45.0  # mass in the chute (kg)
TIME_BOUND = 160.0


class Pavement:
    """A pavement with snow of varying depth, and a chute that holds the snow that the blower has not thrown yet."""

    def __init__(self, rng, density):
        self.rng = rng
        self.density = density * rng.uniform(0.96, 1.04)
        self.depths = rng.uniform(0.2, 0.5, 6)
        self.houses = rng.uniform(2.0, 9.0, 6)
        self.place, self.load = 0.0, 0.0
        self.cleared, self.hit = 0.0, 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the pavement is cleared, or the episode has failed."""
        return self.place >= LENGTH or bool(self.failure)

    @property
    def part(self):
        """Return which sixth of the pavement the blower is in."""
        return min(5, int(6 * max(0.0, self.place) / LENGTH))

    def publish(self, bus):
        """Publish the depth, the distance of the house, and the density of a sample that was weighed this morning."""
        bus.publish("mission/enable", Bool(data=True))
        bus.publish("snow/density", Float32(data=self.density))
        bus.publish("snow/depth", Float32(data=self.depths[self.part] + self.rng.normal(0.0, 0.01)))
        bus.publish("house/range", Float32(data=self.houses[self.part] + self.rng.normal(0.0, 0.05)))

    def advance(self, tracks, chute):
        """Drive, take in snow and throw it for one step."""
        self.time += DT
        speed = tracks.linear.x if tracks else 0.0
        self.cleared = max(0.0, speed) * DT
        self.load += self.density * 0.7 * self.depths[self.part] * self.cleared
        self.load = max(0.0, self.load - THROUGHPUT * DT)
        self.place += speed * DT
        left = chute.data > 0.0 if chute else True
        self.hit = DT if left and self.houses[self.part] < 3.5 else 0.0

    def judge(self):
        """Return the reward of the step: metres are rewarded; time and snow on houses cost."""
        if self.load > CHOKES_AT:
            self.failure = "the chute is choked"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = 0.5 * self.cleared - 0.0005 - 0.2 * self.hit
        return reward - 6.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["snow_blower.py"],
    sensors=[
        Sensor("density", topic="snow/density", field="data", low=100, high=500, bins=4, unit="kg/m3"),
        Sensor("depth", topic="snow/depth", field="data", low=0.15, high=0.55, bins=4, unit="m"),
    ],
    drifts={"wet snow": Drift.range(390.0, 460.0)},
    episodes=100,
    min_success=0.95,
)
def test_clears(tarl, tarl_drift):
    """Clear one pavement."""
    pavement = Pavement(tarl.rng("pavement"), tarl_drift or 170.0)
    tarl.start("snow_blower.py")
    while not pavement.done:
        pavement.publish(tarl.bus)
        tarl.step(DT)
        pavement.advance(tarl.bus.latest("tracks/cmd"), tarl.bus.latest("chute/angle"))
        tarl.reward(pavement.judge())
    assert not pavement.failure, pavement.failure
