"""A crawler lays cable. Full drums, of any radius from 0.4 to 0.6 m, pay out more cable per turn."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
LENGTH = 16.0  # length of the trench (m)
LAYER = 0.02  # decrease of the radius over the trench (m)
LOOPS_AT = 0.4  # length of the cable in the dancer (m)
TIME_BOUND = 90.0


class Trench:
    """A trench, a drum whose radius shrinks while it pays out, and a dancer that takes the difference."""

    def __init__(self, rng, radius):
        self.rng = rng
        self.full = radius
        self.place, self.speed, self.dancer = 0.0, 0.0, 0.2
        self.bends = rng.uniform(0.2, 1.2), rng.uniform(0.0, 6.0)
        self.laid = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the trench is laid, or the episode has failed."""
        return self.place >= LENGTH or bool(self.failure)

    @property
    def radius(self):
        """Return the radius to the middle of the outer layer."""
        return self.full - LAYER * self.place / LENGTH

    def publish(self, bus):
        """Publish speed, curvature, radius and the dancer."""
        bus.publish("mission/armed", Bool(data=True))
        bus.publish("crawler/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.005)))
        bus.publish(
            "trench/curvature", Float32(data=self.bends[0] * math.sin(0.8 * self.place + self.bends[1]))
        )
        bus.publish("drum/radius", Float32(data=self.radius + self.rng.normal(0.0, 0.002)))
        bus.publish("dancer/position", Float32(data=self.dancer + self.rng.normal(0.0, 0.002)))

    def advance(self, cmd, omega):
        """Drive and pay out for one step."""
        self.time += DT
        self.speed += 0.3 * ((cmd.linear.x if cmd else 0.0) - self.speed) + self.rng.normal(0.0, 0.006)
        self.speed = max(0.0, self.speed)
        self.laid = self.speed * DT
        self.place += self.laid
        self.dancer += ((omega.data if omega else 0.0) * self.radius - 1.01 * self.speed) * DT

    def judge(self):
        """Return the reward of the step: metres are rewarded, more near the dancer's middle."""
        if self.dancer > LOOPS_AT:
            self.failure = "the cable lies in loops"
        elif self.dancer < 0.0:
            self.failure = "the cable is pulled"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = 10.0 * self.laid / LENGTH * (1.0 - ((self.dancer - 0.2) / 0.4) ** 2) - 0.0005
        return reward - 4.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["cable_layer.py"],
    sensors=[
        Sensor("radius", topic="drum/radius", field="data", low=0.25, high=0.65, bins=4, unit="m"),
        Sensor("dancer", topic="dancer/position", field="data", low=0.0, high=0.4, bins=5, unit="m"),
    ],
    drifts={"full drum": Drift.range(0.4, 0.6)},
    episodes=100,
    min_success=0.95,
)
def test_lays(tarl, tarl_drift):
    """Lay one trench."""
    trench = Trench(tarl.rng("trench"), tarl_drift or 0.31)
    tarl.start("cable_layer.py")
    while not trench.done:
        trench.publish(tarl.bus)
        tarl.step(DT)
        trench.advance(tarl.bus.latest("crawler/cmd"), tarl.bus.latest("drum/omega"))
        tarl.reward(trench.judge())
    assert not trench.failure, trench.failure
