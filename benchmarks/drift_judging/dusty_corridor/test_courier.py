"""Glasses arrive unbroken: the robot brakes hard rarely and touches nobody. Dust makes single readings too short."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/Range")
Bool = message_type("std_msgs/Bool")

DT = 0.1
LENGTH = 8.0
SIGHT = 5.0  # m
HARD = 0.3  # decrease of speed from one command to the next that breaks a glass, m/s
GLASSES = 2
TIME_BOUND = 21.0


class Corridor:
    """A corridor in which a person stands for a while; `dust` is the share of readings reflected by dust."""

    def __init__(self, rng, dust):
        self.rng = rng
        self.dust = dust
        self.x, self.speed, self.wanted = 0.0, 0.0, 0.0
        self.person = rng.uniform(3.0, 6.5)
        self.patience = rng.uniform(1.0, 3.0)
        self.broken = 0
        self.gained = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def through(self):
        """Return whether the robot is at the end."""
        return self.x >= LENGTH

    @property
    def gap(self):
        """Return the free distance ahead, m."""
        return self.person - self.x if self.patience > 0.0 else SIGHT

    def publish(self, bus):
        """Publish the measurements of sonar and dust meter."""
        seen = min(SIGHT, self.gap) + self.rng.normal(0.0, 0.01)
        if self.rng.random() < self.dust:
            seen = self.rng.uniform(0.05, 0.4)
        bus.publish("/dusty", Bool(data=self.dust > 0.0))
        bus.publish("/front", Range(min_range=0.02, max_range=SIGHT, range=max(0.02, seen)))

    def advance(self, drive):
        """Roll for one step; a person for whom the robot waits goes away."""
        wanted = max(0.0, min(1.0, drive.linear.x)) if drive else 0.0
        if self.wanted - wanted > HARD:
            self.broken += 1
        self.wanted = wanted
        self.speed += (wanted - self.speed) * 0.5
        self.gained = self.speed * DT
        self.x += self.gained
        if self.gap < 1.0:
            self.patience -= DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress, and unbroken glasses."""
        if self.gap < 0.25:
            self.failure = "bumped into a person"
        elif self.broken > GLASSES:
            self.failure = "broke the glasses"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -5.0 if self.failure else 10.0 * self.gained / LENGTH


@pytest.mark.tarl(
    nodes=["courier.py"],
    sensors=[
        Sensor("dusty", topic="/dusty", field="data"),
        Sensor("ahead", topic="/front", field="range", low=0, high=5, bins=5, unit="m"),
    ],
    drifts={"dust": 0.1},
    episodes=100,
    min_success=0.95,
)
def test_brings_the_glasses(tarl, tarl_drift):
    """Come to the end of the corridor."""
    corridor = Corridor(tarl.rng("corridor"), tarl_drift or 0.0)
    tarl.start("courier.py")
    while not (corridor.through or corridor.failure):
        corridor.publish(tarl.bus)
        tarl.step(DT)
        corridor.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(corridor.judge())
    assert corridor.through, corridor.failure
