"""The seam has no pores where the nozzle keeps its distance. Zinc gives smoke, which disturbs the laser."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
String = message_type("std_msgs/msg/String")

DT = 0.05
STICK_OUT = 12.0  # mm
NEAR = 1.3  # tolerated error of the stick-out, mm
PORES = 0.08  # tolerated share of bad seam
TIME_BOUND = 12.0


class Table:
    """A warped plate; `smoke` is the standard deviation of the laser readings, mm."""

    def __init__(self, rng, smoke):
        self.rng = rng
        self.smoke = smoke
        self.length = rng.uniform(55.0, 75.0)
        self.depth = rng.uniform(3.0, 4.0)
        self.wave = rng.uniform(200.0, 260.0)
        self.phase = rng.uniform(0.0, 2.0 * math.pi)
        self.x, self.speed = 0.0, 0.0
        self.height = self.plate(0.0) + STICK_OUT
        self.welded, self.bad, self.good = 0.0, 0.0, 0.0
        self.time = 0.0
        self.done = False
        self.failure = ""

    def plate(self, x):
        """Return the height of the plate: mm."""
        return self.depth * math.sin(2.0 * math.pi * x / self.wave + self.phase)

    def publish(self, bus):
        """Publish job, carriage and laser."""
        bus.publish("seam/length", Float64(data=self.length))
        bus.publish("plate/coating", String(data="zinc" if self.smoke > 0.5 else "none"))
        bus.publish("carriage/position", Float64(data=self.x))
        seen = self.plate(self.x + 3.0) + self.rng.normal(0.0, self.smoke)
        bus.publish("laser/plate", Float64(data=seen))

    def advance(self, height, speed, arc):
        """Weld for one step."""
        if height:
            self.height += (height.data - self.height) * DT / (DT + 0.02)
        self.speed += ((speed.data if speed else 0.0) - self.speed) * 0.7
        gained = max(0.0, min(15.0, self.speed)) * DT
        self.x += gained
        burning = bool(arc and arc.data)
        near = burning and abs(self.height - self.plate(self.x) - STICK_OUT) < NEAR
        self.good = gained if near else 0.0
        self.bad += 0.0 if near else gained
        self.done = self.x >= self.length
        self.time += DT

    def judge(self):
        """Return the reward of the step, for each good millimetre."""
        if self.bad > PORES * self.length:
            self.failure = "pores"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -6.0 if self.failure else 10.0 * self.good / self.length - 0.002


@pytest.mark.tarl(
    nodes=["torch.py", "height.py", "settings.py"],
    sensors=[
        Sensor("coating", topic="plate/coating", field="data", categories=("none", "zinc")),
        Sensor("along", topic="carriage/position", field="data", low=0, high=75, bins=5, unit="mm"),
    ],
    drifts={"zinc smoke": 1.3},
    episodes=100,
    min_success=0.95,
)
def test_welds_without_pores(tarl, tarl_drift):
    """Weld one seam."""
    table = Table(tarl.rng("table"), tarl_drift or 0.05)
    tarl.start("torch.py")
    while not (table.done or table.failure):
        table.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        table.advance(latest("torch/height"), latest("carriage/speed"), latest("torch/arc"))
        tarl.reward(table.judge())
    assert not table.failure, table.failure
