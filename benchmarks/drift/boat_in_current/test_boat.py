"""The boat passes the strait inside the fairway; progress near the middle line is rewarded most."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/PointStamped")
Float64 = message_type("std_msgs/Float64")

DT = 0.25
LENGTH = 110.0
STRAIT = (45.0, 80.0)
HALF_WIDTH = 4.0
TIME_BOUND = 45.0


class Fairway:
    """A fairway with a strait in which a current of `current` m/s may set north."""

    def __init__(self, rng, current):
        self.rng = rng
        self.current = current * rng.uniform(0.9, 1.1)
        self.east, self.north = 0.0, rng.uniform(-1.0, 1.0)
        self.heading, self.turning = rng.uniform(-0.1, 0.1), 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def through(self):
        """Return whether the boat is past the strait."""
        return self.east >= LENGTH

    def publish(self, bus):
        """Publish the measurements of satellite receiver and compass."""
        fix = PointStamped()
        fix.point.x = self.east + self.rng.normal(0.0, 0.1)
        fix.point.y = self.north + self.rng.normal(0.0, 0.1)
        bus.publish("/fix", fix)
        bus.publish("/compass", Float64(data=self.heading + self.rng.normal(0.0, 0.005)))

    def advance(self, rudder, throttle):
        """Sail for one step; the rudder turns the boat with some inertia."""
        angle = max(-0.5, min(0.5, rudder.data)) if rudder else 0.0
        speed = max(0.0, min(5.0, throttle.data)) if throttle else 0.0
        self.turning += (0.9 * angle - self.turning) * DT / 0.8
        self.heading += self.turning * DT
        drift = self.current if STRAIT[0] <= self.east <= STRAIT[1] else 0.0
        self.gained = speed * math.cos(self.heading) * DT
        self.east += self.gained
        self.north += (speed * math.sin(self.heading) + drift) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        reward = 10.0 * self.gained / LENGTH - 0.02 * (self.north / HALF_WIDTH) ** 2
        if abs(self.north) > HALF_WIDTH:
            self.failure = "left the fairway"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return reward - 5.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["boat.py"],
    sensors=[
        Sensor("east", topic="/fix", field="point.x", low=0, high=LENGTH, bins=22, unit="m"),
        Sensor("cross", topic="/fix", field="point.y", low=-4, high=4, bins=8, unit="m"),
    ],
    drifts={"spring tide": 1.35},
    episodes=100,
    min_success=0.95,
)
def test_passes_the_strait(tarl, tarl_drift):
    """Get through without leaving the fairway."""
    fairway = Fairway(tarl.rng("fairway"), tarl_drift or 0.0)
    tarl.start("boat.py")
    while not (fairway.through or fairway.failure):
        fairway.publish(tarl.bus)
        tarl.step(DT)
        fairway.advance(tarl.bus.latest("/rudder"), tarl.bus.latest("/throttle"))
        tarl.reward(fairway.judge())
    assert fairway.through, fairway.failure
