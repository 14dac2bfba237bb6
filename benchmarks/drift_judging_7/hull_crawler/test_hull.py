"""A crawler cleans a strip of a hull.

In a tidal harbour the current pushes the crawler to one side or the other.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.25
LENGTH = 6.5
OVERLAP = 1.8  # width in m that the previous strip has already cleaned
LAG = 5  # number of steps until an echo is evaluated
BAND = 0.09  # m


class Hull:
    """A strip below the waterline."""

    def __init__(self, rng, stream):
        self.rng = rng
        push = stream * rng.uniform(0.85, 1.15)
        self.push = push if rng.random() < 0.5 else -push
        self.push += rng.uniform(-0.003, 0.003)
        self.x, self.y = 0.0, rng.uniform(-0.04, 0.04)
        self.vy = 0.0
        self.echoes = [self.y] * LAG
        self.time, self.clean = 0.0, 0.0

    @property
    def done(self):
        """Return whether the end of the strip is reached, or the time is over."""
        return self.x >= LENGTH or self.time > 60.0

    def publish(self, bus):
        """Publish the delayed echo of the seam, and the depth."""
        bus.publish("sonar/seam", Float32(data=self.echoes.pop(0)))
        bus.publish("depth", Float32(data=1.0 + self.x))

    def advance(self, cmd):
        """Crawl one step and return its reward."""
        self.time += DT
        self.echoes.append(self.y + self.rng.normal(0.0, 0.008))
        if cmd is None:
            return 0.0
        before = self.x
        self.vy += 0.5 * (max(-0.2, min(0.2, cmd.twist.linear.y)) + self.push - self.vy)
        self.y += self.vy * DT
        self.x += max(0.0, min(0.2, cmd.twist.linear.x)) * DT
        if before < OVERLAP:
            return 0.0
        share = (self.x - before) / (LENGTH - OVERLAP)
        off = abs(self.y)
        if off > BAND:
            return -3.0 * share
        self.clean += share
        return 10.0 * share * (1.0 - 0.2 * off / BAND)

    def judge(self):
        """Return the reason for a failed strip, else an empty text."""
        return "" if self.clean > 0.85 else f"only {100 * self.clean:.0f} % of the strip are clean"


@pytest.mark.tarl(
    nodes=["hull_crawler.py"],
    sensors=[
        Sensor("seam", topic="sonar/seam", field="data", low=-0.3, high=0.3, bins=6, unit="m"),
        Sensor("depth", topic="depth", field="data", low=1, high=6, bins=3, unit="m"),
    ],
    drifts={"tide": 0.085},
    episodes=100,
    min_success=0.95,
)
def test_cleans(tarl, tarl_drift):
    """Clean one strip."""
    hull = Hull(tarl.rng("hull"), tarl_drift or 0.0)
    tarl.start("hull_crawler.py")
    while not hull.done:
        hull.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(hull.advance(tarl.bus.latest("crawler/cmd")))
    assert not hull.judge(), hull.judge()
