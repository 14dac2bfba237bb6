"""A cradle rocks a child. Older children are heavier than the newborns that it was built for, each another weight."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
STEPS = 1100
SETTLED = 500
FRAME, LENGTH = 5.0, 0.9  # kg, m
NEWBORN = (3.0, 4.8)  # kg


class Cradle:
    """A cradle that hangs in a frame, with a child of `child` kg."""

    def __init__(self, rng, child):
        self.rng = rng
        self.child = child
        self.damping = 0.05 * rng.uniform(0.95, 1.05)
        self.angle, self.rate = 0.0, float(rng.normal(0.0, 0.01))
        self.now, self.swing, self.peak, self.off, self.gained = 0, 0.0, 0.0, 0, 0.0

    def publish(self, bus):
        """Publish the angle and the weight; a child kicks."""
        bus.publish("cradle/angle", Float32(data=math.degrees(self.angle) + self.rng.normal(0.0, 0.03)))
        if self.now % 10 == 0:
            bus.publish("cradle/weight", Float32(data=self.child + self.rng.normal(0.0, 0.15)))

    def advance(self, push):
        """Swing for one step; in the second half, the amplitude counts."""
        force = push.data if push else 0.0
        omega = math.sqrt(9.81 / LENGTH)
        before = self.angle
        for _ in range(5):
            turn = force / ((FRAME + self.child) * LENGTH) + self.rng.normal(0.0, 0.02)
            self.rate += DT / 5 * (turn - omega**2 * self.angle - 2 * self.damping * omega * self.rate)
            self.angle += DT / 5 * self.rate
        self.peak = max(self.peak, abs(self.angle))
        if before * self.angle < 0.0:
            self.swing, self.peak = math.degrees(self.peak), 0.0
        self.now += 1
        self.gained = 0.0
        if self.now > SETTLED:
            error = abs(self.swing - 8.0)
            self.off += error > 1.5
            self.gained = 0.02 * max(-1.0, 1.0 - (error / 2.5) ** 2)


@pytest.mark.tarl(
    nodes=["cradle_rocker.py"],
    sensors=[
        Sensor("angle", topic="cradle/angle", field="data", low=-12.0, high=12.0, bins=5, unit="°"),
        Sensor("weight", topic="cradle/weight", field="data", low=2.0, high=13.0, bins=5, unit="kg"),
    ],
    drifts={"older children": Drift.range(9.0, 12.0)},
    episodes=200,
    min_success=0.97,
)
def test_rocks(tarl, tarl_drift):
    """Rock a child for a minute."""
    rng = tarl.rng("cradle")
    cradle = Cradle(rng, rng.uniform(*NEWBORN) if tarl_drift is None else tarl_drift)
    tarl.start("cradle_rocker.py")
    for _ in range(STEPS):
        cradle.publish(tarl.bus)
        tarl.step(DT)
        cradle.advance(tarl.bus.latest("frame/push"))
        tarl.reward(cradle.gained)
    assert cradle.off <= 90, f"swing is too narrow or too wide for {DT * cradle.off:.0f} s"
