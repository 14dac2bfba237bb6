"""A ceiling drill makes its hole in time.

In the new building the concrete contains basalt, which is too hard for the hammer.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")

DT = 0.2
DEPTH = 40.0
TIME_BOUND = 26.0
MOST_THRUST, MOST_TURNS = 220.0, 900.0


class Ceiling:
    """A hole in concrete."""

    def __init__(self, rng, hard):
        self.rng = rng
        self.rate = (0.11 if hard else 1.0) * 0.0145 * rng.uniform(0.94, 1.06)
        self.depth, self.heat, self.time = 0.0, 20.0, 0.0
        self.failure, self.finished = "", False

    @property
    def done(self):
        """Return whether the hole is finished or the time is over."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish depth and temperature of the bit."""
        bus.publish("drill/depth", Float64(data=self.depth + self.rng.normal(0.0, 0.05)))
        bus.publish("drill/temperature", Float64(data=self.heat))

    def advance(self, command, finished):
        """Drill one step and return its reward."""
        self.time += DT
        thrust = max(0.0, min(MOST_THRUST, command.x)) if command else 0.0
        turns = max(0.0, min(MOST_TURNS, command.y)) if command else 0.0
        before = self.depth
        self.depth += self.rate * thrust * turns / 740.0 * DT
        self.heat += (0.02 * thrust * turns / 740.0 - 0.03 * (self.heat - 20.0)) * DT
        self.finished = bool(finished and finished.data)
        if self.heat > 130.0:
            self.failure = "the bit glows"
        elif self.finished and self.depth < DEPTH - 1.0:
            self.failure = "the hole is not deep enough"
        elif self.time > TIME_BOUND:
            self.failure = f"late at {self.depth:.0f} mm"
        if self.failure:
            return -6.0
        return 8.0 * (self.depth - before) / DEPTH + (2.0 if self.finished else 0.0)


@pytest.mark.tarl(
    nodes=["wall_driller.py"],
    sensors=[
        Sensor("depth", topic="drill/depth", field="data", low=0, high=40, bins=5, unit="mm"),
        Sensor("heat", topic="drill/temperature", field="data", low=20, high=120, bins=4, unit="°C"),
    ],
    drifts={"basalt": True},
    episodes=100,
    min_success=0.95,
)
def test_drills(tarl, tarl_drift):
    """Drill one hole."""
    ceiling = Ceiling(tarl.rng("ceiling"), bool(tarl_drift))
    tarl.start("wall_driller.py")
    while not ceiling.done:
        ceiling.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        tarl.reward(ceiling.advance(latest("drill/command"), latest("drill/finished")))
    assert not ceiling.failure, ceiling.failure
