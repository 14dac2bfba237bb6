"""Guests ride a water slide. When the pump gives less water, they run out of speed and creep through the run-out.

Each guest who leaves the slide earns, seconds cost a little, and a guest who slides into the one before ends the day.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.5
FULL = 0.95
SLIDE, RUNOUT = 75.0, 12.0  # m


class Pool:
    """A slide whose pump gives a part `flow` of its rating."""

    def __init__(self, rng, flow):
        self.rng = rng
        self.flow = flow
        self.riders = []  # way and speed factor of each
        self.started, self.left, self.waits = 0, 0, 0.0
        self.reacts = float(rng.uniform(0.5, 2.0))
        self.passed_gate, self.passed_runout = False, False
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the guests are in the pool."""
        return bool(self.failure) or self.left >= 9

    def publish(self, bus):
        """Publish the barriers, and the pump every two seconds."""
        if round(self.time / DT) % 4 == 0:
            bus.publish("pump/flow", Float32(data=self.flow + self.rng.normal(0.0, 0.01)))
        if self.passed_gate:
            bus.publish("gate/passed", Bool(data=True))
        if self.passed_runout:
            bus.publish("runout/passed", Bool(data=True))
        self.passed_gate = self.passed_runout = False

    def speed(self, way, skill):
        """Return the speed of a guest in m/s: the last metres depend on the water that carries them."""
        if way < SLIDE:
            return 3.9 * skill
        return skill * max(0.4, 3.4 * self.flow - 1.0)

    def advance(self, green):
        """Ride for one step."""
        self.time += DT
        self.gained = -0.0004
        if green and green.data and self.started < 9:
            self.waits += DT
            if self.waits >= self.reacts:
                self.riders.append([0.0, float(self.rng.uniform(0.95, 1.05))])
                self.started += 1
                self.waits, self.reacts = 0.0, float(self.rng.uniform(0.5, 2.0))
                self.passed_gate = True
        else:
            self.waits = 0.0
        for rider in self.riders:
            rider[0] += DT * self.speed(*rider)
        if self.riders and self.riders[0][0] > SLIDE + RUNOUT:
            self.riders.pop(0)
            self.left += 1
            self.gained += 1.0
            self.passed_runout = True
        if sum(way > SLIDE for way, _ in self.riders) > 1:
            self.failure = "guest slides into the one before"
        if self.time > 420.0:
            self.failure = "queue goes home"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["water_slide.py"],
    sensors=[
        Sensor("flow", topic="pump/flow", field="data", low=0.0, high=1.2, bins=6),
    ],
    drifts={"drought": Drift.range(0.46, 0.56)},
    episodes=200,
    min_success=0.97,
)
def test_rides(tarl, tarl_drift):
    """Let nine guests ride: 1 for each, a small cost per second, -4 for a collision or a long queue."""
    pool = Pool(tarl.rng("pool"), tarl_drift or FULL)
    tarl.start("water_slide.py")
    while not pool.done:
        pool.publish(tarl.bus)
        tarl.step(DT)
        pool.advance(tarl.bus.latest("gate/green"))
        tarl.reward(pool.gained)
    assert not pool.failure, pool.failure
