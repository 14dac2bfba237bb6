"""A bell is rung by pulls in time with its swing. The great bell swings slower than the bell the node is tuned for."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")
String = message_type("std_msgs/String")

DT = 0.1
SUBSTEPS = 5
QUALITY = 3.0  # quality factor of the swing, which rope and bearing damp
STRIKE = 0.6  # angle at which the clapper strikes, rad
PULL = 0.58  # angle at which the full force of the motor would hold the bell, rad
TIME_BOUND = 26.0


class Bell:
    """A bell that swings with a period of about `period` seconds."""

    def __init__(self, rng, period):
        self.rng = rng
        self.name = "small" if period < 1.9 else "great"
        self.omega = 2.0 * math.pi / (period * rng.uniform(0.985, 1.015))
        self.wanted = int(rng.integers(5, 8))
        self.angle, self.rate = rng.uniform(-0.03, 0.03), 0.0
        self.strokes, self.struck, self.rung = 0, False, 0
        self.finished = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the bell has been rung or the time is over."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish the order, the name of the bell, its strokes and its angle."""
        bus.publish("ringer/order", Int32(data=self.wanted))
        bus.publish("bell/name", String(data=self.name))
        bus.publish("bell/strokes", Int32(data=self.strokes))
        bus.publish("bell/angle", Float32(data=self.angle + self.rng.normal(0.0, 0.01)))

    def advance(self, pull, done):
        """Swing for one step; the clapper strikes once per swing."""
        force = PULL * max(0.0, min(1.0, pull.data)) if pull else 0.0
        before = self.strokes
        for _ in range(SUBSTEPS):
            push = self.omega**2 * (force - math.sin(self.angle))
            self.rate += (push - self.omega / QUALITY * self.rate) * DT / SUBSTEPS
            self.angle += self.rate * DT / SUBSTEPS
            if self.angle < 0.0:
                self.struck = False
            elif self.angle > STRIKE and not self.struck:
                self.struck = True
                self.strokes += 1
        self.rung = self.strokes - before
        self.finished = bool(done and done.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step: ordered strokes are rewarded, others cost."""
        if self.time > TIME_BOUND:
            self.failure = f"{self.strokes} of {self.wanted} strokes"
        elif self.strokes > self.wanted + 1:
            self.failure = "rings on"
        if self.failure:
            return -4.0
        return 10.0 / self.wanted * self.rung - 0.004


@pytest.mark.tarl(
    nodes=["ringer.py"],
    sensors=[
        Sensor("bell", topic="bell/name", field="data", categories=("small", "great")),
        Sensor("strokes", topic="bell/strokes", field="data", low=0, high=8, bins=4),
    ],
    drifts={"great bell": 2.2},
    episodes=100,
    min_success=0.95,
)
def test_rings(tarl, tarl_drift):
    """Ring some strokes."""
    bell = Bell(tarl.rng("bell"), tarl_drift or 1.6)
    tarl.start("ringer.py")
    while not bell.done:
        bell.publish(tarl.bus)
        tarl.step(DT)
        bell.advance(tarl.bus.latest("rope/pull"), tarl.bus.latest("ringer/done"))
        tarl.reward(bell.judge())
    assert not bell.failure, bell.failure
