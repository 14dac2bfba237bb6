"""A barn robot keeps its distance to the fence.

A cow has permanently bent the bracket of the sonar inwards.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/msg/Range")

DT = 0.2
GOAL = 0.80
LENGTH = 7.0
BAND = 0.09  # if the distance is wrong by more than this (m), feed is left behind


class Barn:
    """A feed alley along a straight fence."""

    def __init__(self, rng, side):
        self.rng = rng
        self.side = side + rng.uniform(-0.004, 0.004)
        self.x, self.y = 0.0, GOAL + rng.uniform(-0.03, 0.03)
        self.heading = rng.uniform(-0.04, 0.04)  # positive: towards the fence
        self.drag = rng.uniform(-0.01, 0.01)
        self.clean = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the robot has reached the end of the alley or touched the fence, or the episode has failed."""
        return self.x >= LENGTH or self.time > 30.0 or bool(self.failure)

    def publish(self, bus):
        """Publish the range of the sonar."""
        bus.publish("sonar_left", Range(range=self.y - self.side + self.rng.normal(0.0, 0.004)))

    def advance(self, cmd):
        """Drive one step and return its reward."""
        self.time += DT
        if cmd is None:
            return 0.0
        before = self.x
        self.heading += (cmd.angular.z + self.drag) * DT
        self.x += cmd.linear.x * math.cos(self.heading) * DT
        self.y -= cmd.linear.x * math.sin(self.heading) * DT
        moved = self.x - before
        off = abs(self.y - GOAL)
        if self.y < 0.4:
            self.failure = "touched the fence"
            return -5.0
        if off < BAND:
            self.clean += moved
            return 10.0 * moved / LENGTH * (1.0 - 0.5 * off / BAND)
        return -5.0 * moved / LENGTH

    def judge(self):
        """Return the reason for a failed round, else an empty text."""
        if self.failure:
            return self.failure
        return "" if self.clean > 0.9 * LENGTH else f"only {self.clean:.1f} m of feed were pushed"


@pytest.mark.tarl(
    nodes=["feed_pusher.py"],
    sensors=[Sensor("range", topic="sonar_left", field="range", low=0.3, high=0.9, bins=6, unit="m")],
    drifts={"bent bracket": Drift(0.08, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_pushes(tarl, tarl_drift):
    """Drive one round."""
    barn = Barn(tarl.rng("barn"), tarl_drift or 0.22)
    tarl.start("feed_pusher.py")
    while not barn.done:
        barn.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(barn.advance(tarl.bus.latest("cmd_vel")))
    assert not barn.judge(), barn.judge()
