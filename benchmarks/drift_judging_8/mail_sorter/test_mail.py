"""Letters with a stamp pass, others go to the clerks. The lamp of the reader ages, so that stamps glow less."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.01
LETTERS = 12
PAPER, STAMP, LABEL = 30.0, 92.0, 15.0  # counts with a new lamp; stamp and label are relative to the paper


class Reader:
    """Letters that pass below a lamp."""

    def __init__(self, rng, lamp):
        self.rng = rng
        self.lamp = lamp
        self.right = 0

    def letter(self):
        """Return whether a letter has a stamp, and its readings: paper, a label or a stamp, paper, a gap."""
        stamped = self.rng.random() < 0.6
        above = STAMP if stamped else (LABEL if self.rng.random() < 0.5 else 0.0)
        above *= self.rng.uniform(0.88, 1.12)
        before, glow, after = (int(self.rng.integers(low, high)) for low, high in ((3, 6), (5, 8), (2, 4)))
        tops = [0.0] * before + [above] * glow + [0.0] * after
        light = [self.lamp * (PAPER + top) + self.rng.normal(0.0, 1.2) for top in tops]
        return stamped, [*light, 0.5]

    def judge(self, stamped, divert):
        """Return the reward for the destination of a letter."""
        if divert is None:
            return -1.0
        fits = divert.data != stamped
        self.right += fits
        return (10.0 if fits else -10.0) / LETTERS + self.rng.normal(0.0, 0.1)


@pytest.mark.tarl(
    nodes=["sorter.py"],
    sensors=[
        Sensor("lamp", topic="reader/lamp_monitor", field="data", low=0.2, high=1.1, bins=9),
        Sensor("light", topic="reader/light", field="data", low=0, high=150, bins=5),
    ],
    drifts={"aged lamp": Drift.range(0.32, 0.46)},
    episodes=100,
    min_success=0.95,
)
def test_sorts(tarl, tarl_drift):
    """Sort twelve letters."""
    reader = Reader(tarl.rng("reader"), tarl_drift or 1.0)
    tarl.start("sorter.py")
    for _ in range(LETTERS):
        stamped, light = reader.letter()
        tarl.bus.publish("reader/lamp_monitor", Float64(data=reader.lamp + reader.rng.normal(0.0, 0.01)))
        for value in light:
            tarl.bus.publish("reader/light", Float64(data=value))
            tarl.step(DT)
        tarl.reward(reader.judge(stamped, tarl.bus.latest("gate/divert")))
    assert reader.right >= LETTERS - 1, f"{LETTERS - reader.right} letters went the wrong way"
