"""Loaves are cut in their middle. The belt also has a slower programme, of which the knife gets no message."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
String = message_type("std_msgs/String")

DT = 0.05
WAY = 0.6  # m
LOAF = 0.24  # m
OFF = 0.12  # maximum distance of a cut from the middle, m
LOAVES = 2


class Belt:
    """A belt that brings loaves; `speed` in m/s."""

    def __init__(self, rng, speed, bus):
        self.rng = rng
        self.programme = "normal" if speed == 0.5 else "gentle"
        self.speed = speed * rng.uniform(0.98, 1.02)
        self.middles = [-LOAF / 2 - rng.uniform(0.05, 0.2)]  # distance from the light barrier (m)
        self.middles.append(self.middles[0] - LOAF - rng.uniform(0.2, 0.6))
        self.cuts, self.counted = 0, 0
        self.failure = ""
        bus.subscribe("/cut", self.on_cut)

    @property
    def done(self):
        """Return whether all loaves are cut."""
        return self.cuts == LOAVES

    def on_cut(self, _):
        """Cut the loaf that lies below the knife when the blade has fallen."""
        if self.failure or self.done:
            return
        beside = self.middles[self.cuts] + 0.05 * self.speed - WAY
        self.cuts += 1
        if abs(beside) > OFF:
            self.failure = f"cut {abs(beside) * 100:.0f} cm away from the middle"

    def publish(self, bus):
        """Publish the states of light barrier and belt."""
        blocked = any(abs(middle) < LOAF / 2 for middle in self.middles)
        bus.publish("/programme", String(data=self.programme))
        bus.publish("/barrier", Bool(data=blocked))

    def advance(self):
        """Move the belt for one step."""
        self.middles = [middle + self.speed * DT for middle in self.middles]
        if not self.done and self.middles[self.cuts] > WAY + 3 * LOAF:
            self.failure = "missed a loaf"

    def judge(self):
        """Return the reward of the step."""
        if self.failure:
            return -5.0
        new, self.counted = self.cuts - self.counted, self.cuts
        return 5.0 * new


@pytest.mark.tarl(
    nodes=["knife.py"],
    sensors=[
        Sensor("programme", topic="/programme", field="data", categories=("normal", "gentle")),
        Sensor("barrier", topic="/barrier", field="data"),
    ],
    drifts={"gentle programme": 0.32},
    episodes=100,
    min_success=0.95,
)
def test_cuts_in_the_middle(tarl, tarl_drift):
    """Cut two loaves."""
    belt = Belt(tarl.rng("belt"), tarl_drift or 0.5, tarl.bus)
    tarl.start("knife.py")
    while not (belt.done or belt.failure):
        belt.publish(tarl.bus)
        tarl.step(DT)
        belt.advance()
        tarl.reward(belt.judge())
    assert not belt.failure, belt.failure
