"""A crawler turns from one row of vines into the next.

New rubber tracks scrub more, and the crawler turns too little.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32MultiArray = message_type("std_msgs/Float32MultiArray")

DT = 0.2
GAUGE = 0.52
ROW = 2.2
LENGTH = 2.5
FREE = 0.55  # distance from the middle of a row within which no vines stand (m)
TIME_BOUND = 36.0


class Vineyard:
    """Two rows and a headland; `scrub` is the turning width of the tracks over their gauge."""

    def __init__(self, rng, scrub):
        self.rng = rng
        self.width = GAUGE * scrub * rng.normal(1.0, 0.01)
        self.x, self.y, self.heading = 0.0, rng.normal(0.0, 0.03), rng.normal(0.0, 0.01)
        self.ticks = [0.0, 0.0]
        self.speeds = [0.0, 0.0]
        self.time, self.gained, self.best = 0.0, 0.0, 0.0
        self.failure = ""
        self.done = False

    def progress(self):
        """Return the length of the path that is done, m."""
        if self.best < LENGTH - 0.3:
            return max(0.0, min(self.x, LENGTH))
        if self.best < LENGTH + ROW - 0.6:
            return LENGTH - 0.3 + max(0.0, min(self.y, ROW))
        return LENGTH + ROW - 0.6 + max(0.0, LENGTH - self.x)

    def publish(self, bus):
        """Publish the counters of the tracks."""
        bus.publish("tracks", Float32MultiArray(data=[round(value) for value in self.ticks]))

    def advance(self, cmd):
        """Drive for one step."""
        v, w = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        wanted = (v - w * GAUGE / 2, v + w * GAUGE / 2)
        for side in (0, 1):
            self.speeds[side] += 0.75 * (wanted[side] - self.speeds[side])
        left, right = self.speeds
        self.ticks[0] += 400.0 * left * DT
        self.ticks[1] += 400.0 * right * DT
        ahead = (left + right) / 2 * self.rng.normal(1.0, 0.02)
        self.heading += ((right - left) / self.width + self.rng.normal(0.0, 0.008)) * DT
        self.x += ahead * math.cos(self.heading) * DT
        self.y += ahead * math.sin(self.heading) * DT
        before = self.best
        self.best = max(self.best, self.progress())
        self.gained = self.best - before
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress along the path."""
        if self.x < LENGTH - 0.5 and min(abs(self.y), abs(self.y - ROW)) > FREE:
            self.failure = "hits vines"
        elif self.x > LENGTH + 0.9:
            self.failure = "leaves the headland"
        elif self.x < 0.3 and abs(self.y - ROW) < FREE:
            self.done = True
        elif self.time > TIME_BOUND:
            self.failure = "late"
        if self.failure:
            self.done = True
        return 10.0 * self.gained / (2 * LENGTH + ROW - 0.9) - 0.002 - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["vine_crawler.py"],
    sensors=[
        Sensor("left", topic="tracks", field=lambda msg: msg.data[0], low=0.0, high=3000.0, bins=3),
        Sensor("right", topic="tracks", field=lambda msg: msg.data[1], low=0.0, high=4000.0, bins=3),
    ],
    drifts={"rubber tracks": Drift(1.55, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_turns(tarl, tarl_drift):
    """Change to the next row."""
    vineyard = Vineyard(tarl.rng("vineyard"), tarl_drift or 1.0)
    tarl.start("vine_crawler.py")
    while not vineyard.done:
        vineyard.publish(tarl.bus)
        tarl.step(DT)
        vineyard.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(vineyard.judge())
    assert not vineyard.failure, vineyard.failure
