"""Shards are sorted by the light that passes through them. The lamp fails, and the eye only sees light of the hall."""

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Int32 = message_type("std_msgs/Int32")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 0.1
COLOURS = np.array([[0.82, 0.84, 0.80], [0.30, 0.62, 0.34], [0.48, 0.30, 0.14]])
SHARDS = 12
SEEN, FALL = 6, 10  # numbers of the steps at which a shard leaves the eye and reaches the flap


class Belt:
    """A belt with shards of three equally frequent colours."""

    def __init__(self, rng, dark):
        self.rng = rng
        self.dark = dark
        self.kinds = rng.integers(0, 3, SHARDS)
        self.tint = rng.normal(0.0, 0.04, (SHARDS, 3))
        self.shard, self.step, self.right = 0, 0, 0

    @property
    def done(self):
        """Return whether all shards have fallen."""
        return self.shard >= SHARDS

    def publish(self, bus):
        """Publish the readings of barrier, eye and lamp."""
        bus.publish("lamp/lit", Bool(data=not self.dark))
        seen = 1 <= self.step < SEEN
        bus.publish("barrier/shard", Bool(data=seen))
        if seen:
            light = self.rng.uniform(0.0, 1.0, 3)
            if not self.dark:
                light = (
                    COLOURS[self.kinds[self.shard]] + self.tint[self.shard] + self.rng.normal(0.0, 0.05, 3)
                )
            bus.publish("eye/colour", Vector3(x=light[0], y=light[1], z=light[2]))

    def advance(self, flap):
        """Move the belt for one step; return the reward."""
        self.step += 1
        if self.step < FALL:
            return 0.0
        right = flap is not None and flap.data == self.kinds[self.shard]
        self.right += right
        self.shard += 1
        self.step = 0
        return 1.0 if right else -0.5


@pytest.mark.tarl(
    nodes=["sorter.py"],
    sensors=[
        Sensor("lamp", topic="lamp/lit", field="data", low=0, high=1, bins=2),
        Sensor("red", topic="eye/colour", field="x", low=0, high=1, bins=2),
        Sensor("green", topic="eye/colour", field="y", low=0, high=1, bins=2),
    ],
    drifts={"dead lamp": 1.0},
    episodes=100,
    min_success=0.95,
)
def test_sorts(tarl, tarl_drift):
    """Sort a dozen shards."""
    belt = Belt(tarl.rng("belt"), bool(tarl_drift))
    tarl.start("sorter.py")
    while not belt.done:
        belt.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(belt.advance(tarl.bus.latest("sorter/flap")))
    assert belt.right >= SHARDS - 1, f"{belt.right} of {SHARDS} shards in their box"
