"""A leaf of a bridge opens for ships.

After rain the timber deck is heavy, and the bridge does not open far enough.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
JointState = message_type("sensor_msgs/JointState")

DT = 0.2
OPEN = 1.2
TIME_BOUND = 36.0


class Leaf:
    """A leaf with motor, and the ship that waits."""

    def __init__(self, rng, moisture):
        self.rng = rng
        self.moment = 40.0 * (1.0 + 0.85 * moisture) * rng.normal(1.0, 0.02)
        self.rain = 28.0 * moisture + rng.uniform(0.0, 3.0)
        self.inertia = 150.0 * (1.0 + 0.1 * moisture)
        self.angle, self.rate = 0.0, 0.0
        self.time, self.gained, self.held = 0.0, 0.0, 0
        self.gusts = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the ship may pass, or the episode has failed."""
        return bool(self.failure) or self.held >= 10

    def publish(self, bus):
        """Publish leaf, ship and rain gauge."""
        joint = JointState(name=["leaf"])
        joint.position = [self.angle + self.rng.normal(0.0, 0.002)]
        joint.velocity = [self.rate + self.rng.normal(0.0, 0.004)]
        bus.publish("leaf/joint", joint)
        bus.publish("ship_waits", Bool(data=True))
        bus.publish("rain_gauge", Float32(data=max(0.0, self.rain + self.rng.normal(0.0, 0.3))))

    def advance(self, cmd):
        """Move the leaf for one step."""
        torque = cmd.data if cmd else 0.0
        self.gusts = 0.9 * self.gusts + self.rng.normal(0.0, 0.5)
        before = self.angle
        for _ in range(4):
            load = self.moment * math.cos(self.angle) + 20.0 * self.rate + self.gusts
            self.rate += (torque - load) / self.inertia * DT / 4
            self.angle += self.rate * DT / 4
            if self.angle < 0.0:
                self.angle, self.rate = 0.0, 0.0
        self.gained = self.angle - before
        self.time += DT

    def judge(self):
        """Return the reward of the step: the angle gained; a leaf outside the band stops for good."""
        path = min(OPEN, 0.06 * self.time)
        self.held = self.held + 1 if self.angle > OPEN - 0.12 else 0
        if self.angle > OPEN + 0.15:
            self.failure = "hits the stop"
        elif self.time > 6.0 and self.angle < path - 0.32:
            self.failure = "lags behind its twin leaf"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return 10.0 * self.gained / OPEN - 0.003 - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["bascule_bridge.py"],
    sensors=[
        Sensor("rain", topic="rain_gauge", field="data", low=0.0, high=40.0, bins=8, unit="mm"),
        Sensor("angle", topic="leaf/joint", field=lambda msg: msg.position[0], low=0.0, high=1.2, bins=3),
    ],
    drifts={"soaked deck": 1.0},
    episodes=200,
    min_success=0.97,
)
def test_opens(tarl, tarl_drift):
    """Open for one ship."""
    leaf = Leaf(tarl.rng("leaf"), tarl_drift or 0.0)
    tarl.start("bascule_bridge.py")
    while not leaf.done:
        leaf.publish(tarl.bus)
        tarl.step(DT)
        leaf.advance(tarl.bus.latest("leaf/torque"))
        tarl.reward(leaf.judge())
    assert not leaf.failure, leaf.failure
