"""A crane carries loads along an aisle. Long slings make the pendulum a third longer, and loads sway."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 0.1
G = 9.81
SWAY = 0.085  # half of the free space beside a load (m)
NEAR = 0.2  # m
TIME_BOUND = 19.5


class Hall:
    """A trolley with a load on a rope."""

    def __init__(self, rng, longer):
        self.rng = rng
        self.rope = rng.uniform(4.6, 5.4)
        self.length = (self.rope + 5.0 * (longer - 1.0)) * rng.normal(1.0, 0.01)
        self.sling = 1.2 + 5.0 * (longer - 1.0)
        self.goal = rng.uniform(7.5, 9.0)
        self.x, self.v = 0.0, 0.0
        self.sway, self.rate = rng.normal(0.0, 0.005), 0.0
        self.time, self.gained, self.still = 0.0, 0.0, 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the load hangs still at the goal, or the episode has failed."""
        return bool(self.failure) or self.still >= 25

    def publish(self, bus):
        """Publish trolley, hoist, goal and the sling that the hook holds."""
        bus.publish("crane/position", Float32(data=self.x + self.rng.normal(0.0, 0.005)))
        bus.publish("crane/hoist", Float32(data=self.rope + self.rng.normal(0.0, 0.005)))
        bus.publish("crane/sling", Float32(data=self.sling + self.rng.normal(0.0, 0.03)))
        if self.time == 0.0:
            bus.publish("crane/goal", Float32(data=self.goal))

    def advance(self, cmd):
        """Move trolley and load for one step."""
        wanted = cmd.data if cmd else 0.0
        before = self.x
        for _ in range(10):
            pull = (wanted - self.v) / 0.12
            self.v += pull * DT / 10
            self.x += self.v * DT / 10
            force = -G / self.length * self.sway - pull - 0.01 * self.rate + self.rng.normal(0.0, 0.02)
            self.rate += force * DT / 10
            self.sway += self.rate * DT / 10
        self.gained = min(self.x, self.goal) - min(before, self.goal)
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress minus sway in the aisle."""
        swing = math.hypot(self.sway, self.rate * math.sqrt(self.length / G))
        aisle = 1.6 < self.x < self.goal - 1.9
        rest = abs(self.x - self.goal) < NEAR and self.v < 0.02
        if aisle and abs(self.sway) > SWAY:
            self.failure = "the load touches a shelf"
        elif rest:
            self.still += 1
            if self.still == 25 and swing > SWAY:
                self.failure = "the load still swings"
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        cost = 0.2 * abs(self.sway) if aisle or rest else 0.0
        return 10.0 * self.gained / self.goal - cost - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["overhead_crane.py"],
    sensors=[
        Sensor("sling", topic="crane/sling", field="data", low=0.0, high=4.0, bins=8, unit="m"),
        Sensor("position", topic="crane/position", field="data", low=0.0, high=9.0, bins=3, unit="m"),
    ],
    drifts={"long slings": 1.35},
    episodes=200,
    min_success=0.97,
)
def test_carries(tarl, tarl_drift):
    """Carry one load."""
    hall = Hall(tarl.rng("hall"), tarl_drift or 1.0)
    tarl.start("overhead_crane.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("crane/speed"))
        tarl.reward(hall.judge())
    assert not hall.failure, hall.failure
