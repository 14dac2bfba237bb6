"""Each well gets its volume. Glycerol follows the piston with a delay, which grows with its concentration."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
Float64MultiArray = message_type("std_msgs/Float64MultiArray")
String = message_type("std_msgs/String")

DT = 0.05
WELLS = 3
WRONG = 0.05  # tolerated relative error of the volume in a well
TIME_BOUND = 33.0
SURFACE = 10.0  # height of the liquid in the trough, mm


class Deck:
    """A trough and a row of wells; the liquid follows the piston with a lag of `lag` s."""

    def __init__(self, rng, lag):
        self.rng = rng
        self.lag = lag
        self.volumes = [float(rng.uniform(40.0, 100.0)) for _ in range(WELLS)]
        self.z, self.piston, self.tip, self.gained = 20.0, 0.0, 0.0, 0.0
        self.x, self.got, self.judged = -1, [0.0] * WELLS, 0
        self.time = 0.0
        self.done = False
        self.failure = ""

    def publish(self, bus):
        """Publish the job, the label of the trough, and the head."""
        if self.time == 0.0:
            bus.publish("trough/label", String(data="glycerol" if self.lag > 0.3 else "buffer"))
            bus.publish("row/volumes", Float64MultiArray(data=self.volumes))
        bus.publish("head/z_state", Float64(data=self.z))

    def advance(self, bus):
        """Move head, piston and liquid for one step."""
        names = ("head/x", "head/z", "head/piston", "head/piston_speed", "row/status")
        x, z, piston, speed, status = (bus.latest(name) for name in names)
        self.x = x.data if x else self.x
        if z:
            self.z += max(-60.0 * DT, min(60.0 * DT, z.data - self.z))
        before = self.piston
        if piston and speed:
            most = speed.data * DT
            self.piston += max(-most, min(most, piston.data - self.piston))
        if self.x < 0 and self.z < SURFACE:
            self.tip += (self.piston - self.tip) * (1.0 - math.exp(-DT / self.lag))
        elif self.piston < before and self.x >= 0 and self.z < 8.0:
            out = min(self.tip, before - self.piston)
            self.tip -= out
            self.got[self.x] += out
        self.done = bool(status and status.data == "done")
        self.time += DT

    def judge(self):
        """Return the reward of the step, for each well that the head has just left."""
        reward = -0.005
        while self.judged < WELLS and (self.done or (self.x < 0 and self.got[self.judged] > 0.0)):
            wrong = abs(self.got[self.judged] / self.volumes[self.judged] - 1.0)
            if wrong > WRONG:
                self.failure = f"well {self.judged} is wrong by {100 * wrong:.0f} %"
            reward += 4.0 - 10.0 * wrong if wrong <= WRONG else -1.5
            self.judged += 1
        if self.time > TIME_BOUND and not self.done:
            self.failure, self.done = "late", True
            reward -= 4.0
        return reward


@pytest.mark.tarl(
    nodes=["pipettor.py", "liquid_classes.py"],
    sensors=[
        Sensor("trough", topic="trough/label", field="data", categories=("buffer", "glycerol")),
        Sensor("height", topic="head/z_state", field="data", low=0, high=20, bins=4, unit="mm"),
    ],
    drifts={"glycerol": Drift.range(0.7, 1.5)},
    episodes=100,
    min_success=0.95,
)
def test_fills_a_row(tarl, tarl_drift):
    """Fill one row."""
    deck = Deck(tarl.rng("deck"), tarl_drift or 0.12)
    tarl.start("pipettor.py")
    while not deck.done:
        deck.publish(tarl.bus)
        tarl.step(DT)
        deck.advance(tarl.bus)
        tarl.reward(deck.judge())
    assert not deck.failure, deck.failure
