"""Rounds end in time.

The robot makes a detour at a locked door; in winter some doors are stiff and open slowly.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
LaserScan = message_type("sensor_msgs/LaserScan")

DT = 0.1
LENGTH = 7.0
SIGHT = 4.0  # m
LOCKED = 0.08  # share of rounds with a locked door
DETOUR = 9.0  # duration of the detour, s


class House:
    """A corridor with two doors; in a share `stiff` of the rounds, one of the doors is stiff."""

    def __init__(self, rng, stiff):
        self.rng = rng
        self.outside = rng.uniform(-10.0, 2.0) if stiff > 0.0 else rng.uniform(8.0, 22.0)
        self.doors = [rng.uniform(1.5, 2.5), rng.uniform(4.0, 5.0)]
        self.needs = [rng.uniform(0.4, 1.5), rng.uniform(0.4, 1.5)]  # pushing, s
        self.locked = rng.random() < LOCKED
        if self.locked:
            self.needs[int(rng.integers(2))] = 1e6
        elif rng.random() < stiff:
            self.needs[int(rng.integers(2))] = rng.uniform(3.2, 4.5)
        self.x = 0.0
        self.gained = 0.0
        self.time = 0.0
        self.detour = False
        self.failure = ""

    @property
    def through(self):
        """Return whether the round is done."""
        return self.x >= LENGTH or (self.detour and self.locked)

    @property
    def ahead(self):
        """Return the index of the next closed door, or None."""
        return next((i for i, need in enumerate(self.needs) if need > 0.0), None)

    @property
    def gap(self):
        """Return the free distance in the corridor, m."""
        return SIGHT if self.ahead is None else min(SIGHT, self.doors[self.ahead] - self.x)

    def publish(self, bus):
        """Publish the outdoor temperature and a scan with three rays to the front."""
        bus.publish("/outside", Float32(data=self.outside + self.rng.normal(0.0, 0.2)))
        rays = [max(0.02, min(SIGHT, self.gap + self.rng.normal(0.0, 0.01))) for _ in range(3)]
        bus.publish("/scan", LaserScan(range_min=0.02, range_max=SIGHT, ranges=rays))

    def advance(self, speed, detour):
        """Drive or push for one step; a door opens after enough pushing."""
        wanted = max(-0.5, min(1.0, speed.data)) if speed else 0.0
        before = self.x
        self.x += wanted * DT
        door = self.ahead
        if door is not None and self.x >= self.doors[door] - 0.05:
            self.x = self.doors[door] - 0.05
            if wanted >= 0.1:
                self.needs[door] -= DT
        self.gained = self.x - before
        self.detour = bool(detour and detour.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress minus a cost of time."""
        if self.detour and not self.locked:
            self.failure = "took the detour although the door opens"
        elif self.time > 40.0:
            self.failure = "late"
        if self.failure:
            return -20.0
        if self.through and self.detour:
            return 10.0 * (1.0 - self.x / LENGTH) - 0.05 * DETOUR
        return 10.0 * self.gained / LENGTH - 0.05 * DT


@pytest.mark.tarl(
    nodes=["corridor.py"],
    sensors=[
        Sensor("outside", topic="/outside", field="data", low=-10, high=20, bins=6, unit="°C"),
        Sensor("middle", topic="/scan", field="ranges.1", low=0, high=4, bins=5, unit="m"),
    ],
    drifts={"winter": 0.13},
    episodes=150,
    min_success=0.95,
)
def test_does_its_round(tarl, tarl_drift):
    """Go through both doors."""
    house = House(tarl.rng("house"), tarl_drift or 0.0)
    tarl.start("corridor.py")
    while not (house.through or house.failure):
        house.publish(tarl.bus)
        tarl.step(DT)
        house.advance(tarl.bus.latest("/speed"), tarl.bus.latest("/detour"))
        tarl.reward(house.judge())
    assert house.through, house.failure
