"""Passengers leave over a bridge. An aircraft with soft struts rises as passengers and bags leave it."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.2
TRIP = 0.15  # step at the sill over which people fall (m)
PASSENGERS = 40
TIME_BOUND = 90.0


class Stand:
    """An aircraft on its stand, and a bridge in front of its door; in total, the door rises by `rise` metres."""

    def __init__(self, rng, rise):
        self.rng = rng
        self.rise = rise * rng.uniform(0.9, 1.1)
        self.door = float(rng.uniform(3.0, 3.8))
        self.floor = self.door + rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 0.6)
        self.gap = float(rng.uniform(3.0, 5.0))
        self.docked = False
        self.left = 0.0  # number of passengers who have left
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all passengers are out, or the episode has failed."""
        return self.left >= PASSENGERS or bool(self.failure)

    def publish(self, bus):
        """Publish the step up from the bridge's floor to the door, the gap, and the messages of the crew."""
        step = self.door - self.floor + self.rng.normal(0.0, 0.004)
        bus.publish("bridge/step", Float32(data=step))
        bus.publish("bridge/gap", Float32(data=max(0.0, self.gap + self.rng.normal(0.0, 0.005))))
        bus.publish("bridge/occupied", Bool(data=0 < self.left < PASSENGERS))

    def advance(self, lift, tunnel, docked):
        """Move bridge, aircraft and passengers for one step; return the reward."""
        self.floor += DT * max(-0.12, min(0.12, lift.data)) if lift else 0.0
        self.gap -= DT * max(-0.5, min(0.5, tunnel.data)) if tunnel else 0.0
        self.time += DT
        out = 0.0
        if docked and docked.data:
            out = DT * 1.25
            self.left += out
            self.door += self.rise * out / PASSENGERS
            if self.gap > 0.15:
                self.failure = "a gap at the sill"
            elif abs(self.door - self.floor) > TRIP:
                self.failure = f"passenger {self.left:.0f} falls"
        if self.gap < -0.12:
            self.failure = "the door is dented"
        elif self.time > TIME_BOUND:
            self.failure = "they still sit"
        return -4.0 if self.failure else 10.0 * out / PASSENGERS - 0.003


@pytest.mark.tarl(
    nodes=["bridge.py"],
    sensors=[
        Sensor("step", topic="bridge/step", field="data", low=-0.6, high=0.6, bins=6),
        Sensor("gap", topic="bridge/gap", field="data", low=0, high=5, bins=4),
    ],
    drifts={"soft struts": 0.45},
    episodes=100,
    min_success=0.95,
)
def test_docks(tarl, tarl_drift):
    """Let all passengers out."""
    stand = Stand(tarl.rng("stand"), tarl_drift or 0.05)
    tarl.start("bridge.py")
    while not stand.done:
        stand.publish(tarl.bus)
        tarl.step(DT)
        topics = ("bridge/lift", "bridge/tunnel", "bridge/docked")
        tarl.reward(stand.advance(*(tarl.bus.latest(topic) for topic in topics)))
    assert not stand.failure, stand.failure
