"""The vehicle stops in its bay in time without touching the wall. Only the end is rewarded."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/Range")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
TIME_BOUND = 11.0
BAY = (0.25, 0.55)  # distances from the wall (m)
RADIUS = 0.05
TOP_TURNS = 100.0


class Aisle:
    """A straight aisle; `wear` is the radius of the worn wheels as a share of that of new ones."""

    def __init__(self, rng, wear):
        self.rng = rng
        self.radius = RADIUS * wear
        self.gap = rng.uniform(6.0, 8.0)
        self.load = rng.uniform(50.0, 350.0)
        self.speed = 0.0
        self.standing = 0
        self.time = 0.0
        self.failure = ""

    @property
    def docked(self):
        """Return whether the vehicle has stood in its bay for half a second."""
        return self.standing >= 5

    def publish(self, bus):
        """Publish the measurements of scanner and scales."""
        bus.publish("/range", Range(range=self.gap + self.rng.normal(0.0, 0.01)))
        bus.publish("/load", Float32(data=self.load))

    def advance(self, command):
        """Let the wheels turn for one step."""
        turns = max(-TOP_TURNS, min(TOP_TURNS, command.data)) if command else 0.0
        self.speed += (turns * self.radius - self.speed) * 0.5
        self.gap -= self.speed * DT
        self.time += DT
        inside = BAY[0] <= self.gap <= BAY[1] and abs(self.speed) < 0.05
        self.standing = self.standing + 1 if inside else 0

    def judge(self):
        """Return the reward of the step, which is 0 before the end."""
        if self.docked:
            return 10.0 - 2.0 * self.time / TIME_BOUND
        if self.gap < 0.1:
            self.failure = "touched the wall"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -5.0 if self.failure else 0.0


@pytest.mark.tarl(
    nodes=["vehicle.py"],
    sensors=[
        Sensor("gap", topic="/range", field="range", low=0, high=8, bins=16, unit="m"),
        Sensor("load", topic="/load", field="data", low=0, high=400, bins=4, unit="kg"),
    ],
    drifts={"worn wheels": 0.45},
    episodes=100,
    min_success=0.95,
)
def test_docks(tarl, tarl_drift):
    """Stand in the bay in time."""
    aisle = Aisle(tarl.rng("aisle"), tarl_drift or 1.0)
    tarl.start("vehicle.py")
    while not (aisle.docked or aisle.failure):
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("/wheels"))
        tarl.reward(aisle.judge())
    assert aisle.docked, aisle.failure
