"""A bead of concrete is neither too thin nor too wide. The second pump has worn rubber and delivers less per turn."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.2
LENGTH = 2.4
WINDOW = 0.12  # share of the width of the bead
TIME_BOUND = 40.0


class Wall:
    """One layer of a wall with two straights and two bends."""

    def __init__(self, rng, per_turn):
        self.rng = rng
        self.pump = 2 if per_turn < 0.03 else 1
        self.per_turn = per_turn * rng.uniform(0.985, 1.015)
        self.bends = [(at, at + rng.uniform(0.2, 0.4)) for at in rng.uniform([0.3, 1.4], [0.9, 1.9])]
        self.x, self.time = 0.0, 0.0
        self.bad = 0.0

    @property
    def done(self):
        """Return whether the layer is printed, or the time is over."""
        return self.x >= LENGTH or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish the path and which pump is connected."""
        bend = any(low < self.x < high for low, high in self.bends)
        bus.publish("pump/number", UInt8(data=self.pump))
        bus.publish("path/curvature", Float64(data=3.0 if bend else 0.0))

    def advance(self, speed, turns):
        """Print one step and return its reward."""
        self.time += DT
        if not speed or not turns or speed.data <= 0.0:
            return -0.05
        moved = min(0.15, speed.data) * DT
        flow = turns.data * self.per_turn * (1.0 + self.rng.normal(0.0, 0.02))
        bead = flow * DT / 1000.0 / (moved * 0.05 * 0.015)
        self.x += moved
        off = abs(bead - 1.0)
        if off > WINDOW:
            self.bad += moved
            return -4.0 * moved / LENGTH
        return 10.0 * moved / LENGTH * (1.0 - 0.3 * off / WINDOW)

    def judge(self):
        """Return the fault of the layer as text."""
        if self.x < LENGTH:
            return "late"
        return f"{self.bad:.2f} m of the bead are faulty" if self.bad > 0.15 * LENGTH else ""


@pytest.mark.tarl(
    nodes=["printer.py"],
    sensors=[
        Sensor("pump", topic="pump/number", field="data"),
        Sensor("curvature", topic="path/curvature", field="data", edges=(1.0,), unit="1/m"),
    ],
    drifts={"pump two": 0.0214},
    episodes=100,
    min_success=0.95,
)
def test_prints(tarl, tarl_drift):
    """Print one layer."""
    wall = Wall(tarl.rng("wall"), tarl_drift or 0.031)
    tarl.start("printer.py")
    while not wall.done:
        wall.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        tarl.reward(wall.advance(latest("gantry/speed"), latest("pump/turns_per_s")))
    assert not wall.judge(), wall.judge()
