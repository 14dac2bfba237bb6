"""A saw cuts boards of one thickness. From now on, the mill buys blades with a wider set."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Int32 = message_type("std_msgs/msg/Int32")

DT = 4.0
BOARD = 27.0
TOLERANCE = 1.1  # mm


class Mill:
    """A log on the carriage of a band saw."""

    def __init__(self, rng, kerf):
        self.rng = rng
        self.kerf = kerf + rng.uniform(-0.08, 0.08)
        self.left = rng.uniform(330.0, 430.0)  # mm
        self.hard = rng.uniform(0.6, 1.3)
        self.whole = self.left
        self.cuts, self.bad, self.good = 0, 0, 0
        self.finished = False

    def publish(self, bus):
        """Publish the rest of the log and the motor current of the band."""
        if not self.cuts:
            bus.publish("log/new", Int32(data=1))
        bus.publish("band/current", Float64(data=26.0 * self.hard + self.rng.normal(0.0, 2.0)))
        bus.publish("log/face", Float64(data=self.left + self.rng.normal(0.0, 0.5)))

    def advance(self, setting):
        """Cut once and return the value of the piece."""
        if setting is None:
            return -0.1
        if setting.z > 0.5 or self.cuts > 40:
            self.finished = True
            return 0.0
        self.cuts += 1
        moved = max(4.0, setting.x)
        self.left -= moved
        if self.cuts == 1:
            return 0.0
        off = abs(moved - self.kerf + self.rng.normal(0.0, 0.18) - BOARD)
        share = 10.0 * moved / self.whole
        if off < TOLERANCE:
            self.good += 1
            return share * (1.0 - 0.2 * off / TOLERANCE)
        self.bad += 1
        return -0.4 * share


@pytest.mark.tarl(
    nodes=["saw.py"],
    sensors=[
        Sensor("current", topic="band/current", field="data", low=12, high=40, bins=4, unit="A"),
        Sensor("face", topic="log/face", field="data", low=0, high=450, bins=3, unit="mm"),
    ],
    drifts={"wide set": Drift(4.6, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_saws(tarl, tarl_drift):
    """Saw one log."""
    mill = Mill(tarl.rng("mill"), tarl_drift or 2.8)
    tarl.start("saw.py")
    while not mill.finished:
        mill.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(mill.advance(tarl.bus.latest("carriage/setting")))
    assert mill.bad <= 1, f"{mill.bad} boards have a wrong thickness"
    assert mill.good >= 7, f"{mill.good} good boards"
