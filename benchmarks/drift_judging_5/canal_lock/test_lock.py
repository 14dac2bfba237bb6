"""A boat is raised in a lock.

In a flood the fall is higher, and the same opening of the sluice puts more load on the boat's lines.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.25
SLUICE = 0.16  # rise of the chamber's level at one metre of fall, m/s
LINES = 0.107  # rise that the boat's lines tolerate, m/s
TIME_BOUND = 100.0


class Lock:
    """A lock with one boat below."""

    def __init__(self, rng, flood):
        self.rng = rng
        self.flood = bool(flood)
        self.fall = self.height = float(rng.uniform(3.3, 3.7) if flood else rng.uniform(1.8, 2.4))
        self.sluice = SLUICE * rng.uniform(0.98, 1.02)
        self.lines = LINES * rng.uniform(0.98, 1.02)
        self.rise = 0.0
        self.time = 0.0
        self.through = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the boat is through or can no longer pass."""
        return self.through or bool(self.failure)

    def publish(self, bus):
        """Publish the level, the light barrier and the warning of the weir."""
        bus.publish("lock/fall", Float32(data=max(0.0, self.fall + self.rng.normal(0.0, 0.005))))
        bus.publish("lock/boat", Bool(data=True))
        bus.publish("weir/flood", Bool(data=self.flood))

    def advance(self, sluice, gate):
        """Let water in for one step; return the reward."""
        opening = max(0.0, min(1.0, sluice.data)) if sluice else 0.0
        self.rise = self.sluice * opening * math.sqrt(max(0.0, self.fall))
        raised = min(self.fall, self.rise * DT)
        self.fall -= raised
        self.time += DT
        if self.rise > self.lines:
            self.failure = "the lines have snapped"
        elif gate and gate.data:
            self.through = self.fall < 0.08
            self.failure = "" if self.through else "the gate is jammed by the water"
        elif self.time > TIME_BOUND:
            self.failure = "the boat still waits"
        if self.failure:
            return -5.0
        return 10.0 * raised / self.height - 0.002


@pytest.mark.tarl(
    nodes=["lock_keeper.py"],
    sensors=[
        Sensor("flood", topic="weir/flood", field="data", low=0, high=1, bins=2),
        Sensor("fall", topic="lock/fall", field="data", low=0, high=4, bins=4),
    ],
    drifts={"flood": 1.0},
    episodes=100,
    min_success=0.95,
)
def test_lifts(tarl, tarl_drift):
    """Raise one boat."""
    lock = Lock(tarl.rng("lock"), tarl_drift)
    tarl.start("lock_keeper.py")
    while not lock.done:
        lock.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(lock.advance(tarl.bus.latest("lock/sluice"), tarl.bus.latest("lock/gate")))
    assert not lock.failure, lock.failure
