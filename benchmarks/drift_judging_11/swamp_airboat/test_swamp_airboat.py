"""An airboat follows a channel.

A new pair of larger rudders turns the boat harder, and it weaves into the reeds.
"""

import math
from itertools import pairwise

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

PoseStamped = message_type("geometry_msgs/msg/PoseStamped")

DT = 0.2
LENGTH = 100.0
CHANNEL = 1.5  # half of the width of the channel (m)
POINTS = [(0.0, 0.0), (25.0, 4.0), (50.0, 0.0), (80.0, 6.0), (140.0, 6.0)]
TIME_BOUND = 38.0


def middle(x):
    """Return the y of the middle of the channel at x."""
    for (x0, y0), (x1, y1) in pairwise(POINTS):
        if x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return POINTS[-1][1]


class Swamp:
    """An airboat, which slides sideways, with rudders of a given strength."""

    def __init__(self, rng, rudders):
        self.rng = rng
        self.rudders = 1.5 * rudders * rng.normal(1.0, 0.03)
        self.x, self.y, self.heading = 0.0, rng.normal(0.0, 0.2), 0.15 + rng.normal(0.0, 0.05)
        self.rate, self.speed, self.angle, self.slip = 0.0, 3.0, 0.0, 0.0
        self.time, self.gained, self.gust = 0.0, 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the boat is through or has failed."""
        return bool(self.failure) or self.x >= LENGTH

    def publish(self, bus):
        """Publish position and heading."""
        msg = PoseStamped()
        msg.pose.position.x = self.x + self.rng.normal(0.0, 0.05)
        msg.pose.position.y = self.y + self.rng.normal(0.0, 0.05)
        heading = self.heading + self.rng.normal(0.0, 0.006)
        msg.pose.orientation.z, msg.pose.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
        bus.publish("fix", msg)

    def advance(self, cmd):
        """Glide for one step."""
        thrust, wanted = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        wanted = max(-0.7, min(0.7, wanted))
        self.gust = 0.9 * self.gust + self.rng.normal(0.0, 0.02)
        before = self.x
        for _ in range(4):
            h = DT / 4
            self.angle += (wanted - self.angle) / 0.35 * h
            self.rate += (self.rudders * self.angle - 1.0 * self.rate + self.gust) * h
            self.heading += self.rate * h
            self.speed += (6.0 * max(0.0, thrust) - self.speed) * 0.5 * h
            self.slip += (-self.speed * self.rate * 0.3 - self.slip / 0.6) * h
            self.x += (self.speed * math.cos(self.heading) - self.slip * math.sin(self.heading)) * h
            self.y += (self.speed * math.sin(self.heading) + self.slip * math.cos(self.heading)) * h
        self.gained = self.x - before
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress minus the distance from the middle."""
        off = abs(self.y - middle(self.x)) / CHANNEL
        if off > 1.0:
            self.failure = "in the reeds"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return 10.0 * self.gained / LENGTH - 0.005 * off - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["swamp_airboat.py"],
    sensors=[
        Sensor("x", topic="fix", field="pose.position.x", low=0.0, high=100.0, bins=4, unit="m"),
        Sensor("y", topic="fix", field="pose.position.y", low=-3.0, high=9.0, bins=3, unit="m"),
    ],
    drifts={"larger rudders": Drift(4.0, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_follows_the_channel(tarl, tarl_drift):
    """Follow the channel once."""
    swamp = Swamp(tarl.rng("swamp"), tarl_drift or 1.0)
    tarl.start("swamp_airboat.py")
    while not swamp.done:
        swamp.publish(tarl.bus)
        tarl.step(DT)
        swamp.advance(tarl.bus.latest("cmd"))
        tarl.reward(swamp.judge())
    assert not swamp.failure, swamp.failure
