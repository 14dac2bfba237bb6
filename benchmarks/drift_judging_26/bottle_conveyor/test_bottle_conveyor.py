"""A belt brings empty bottles to a filler. Tall bottles topple if the belt changes its speed abruptly.

Each filled bottle earns, and each step in which the filler waits or the buffer is full costs; fallen bottles stop it.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
SHORT = {"height": 0.21, "topple": 3.6}  # m, m/s2
TALL = {"height": 0.33, "topple": 0.75}


class Hall:
    """A belt with bottles that `topple` at some acceleration."""

    def __init__(self, rng, height, topple):
        self.rng = rng
        self.height = height
        self.topple = topple * rng.normal(1.0, 0.02)
        self.belt = 0.0
        self.lag = 0.2 * rng.normal(1.0, 0.05)  # s
        self.way = 0.0
        self.fill = float(rng.integers(6, 10))
        self.rate = float(rng.uniform(2.3, 2.7))  # bottles per s of the filler
        self.change = float(rng.uniform(6.0, 9.0))
        self.shaken = 0.0
        self.passed = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the shift is over."""
        return bool(self.failure) or self.time >= 40.0

    def publish(self, bus):
        """Publish the buffer, the panel, and bottles that pass the gate."""
        bus.publish("buffer/fill", Int32(data=max(0, round(self.fill + self.rng.normal(0.0, 0.4)))))
        if round(self.time / DT) % 10 == 5:
            bus.publish("panel/run", Bool(data=True))
        if self.passed:
            self.passed = 0
            bus.publish("gate/bottle", Float32(data=self.height + self.rng.normal(0.0, 0.002)))

    def advance(self, command):
        """Work for one step."""
        self.time += DT
        before = self.belt
        self.belt += DT / self.lag * ((command.data if command else 0.0) - self.belt)
        self.shaken = self.shaken + DT if abs(self.belt - before) / DT > self.topple else 0.0
        self.way += DT * self.belt
        while self.way > 0.09:
            self.way -= 0.09
            self.fill += 1.0
            self.passed += 1
        self.change -= DT
        if self.change < 0.0:
            self.rate = (
                float(self.rng.uniform(2.3, 5.4)) if self.rate < 2.8 else float(self.rng.uniform(1.0, 2.6))
            )
            self.change = float(self.rng.uniform(4.0, 8.0))
        taken = min(self.fill, self.rate * DT)
        self.fill -= taken
        self.gained = 0.075 * taken
        if self.fill < 0.5:
            self.gained -= 0.02
        if self.shaken > 0.04:
            self.failure = "bottles fall"
        elif self.fill > 42.0:
            self.failure = "buffer overflows"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["bottle_conveyor.py"],
    sensors=[
        Sensor("fill", topic="buffer/fill", field="data", low=0.0, high=40.0, bins=8, unit="bottles"),
        Sensor("height", topic="gate/bottle", field="data", low=0.1, high=0.4, bins=6, unit="m"),
    ],
    drifts={"tall": TALL},
    episodes=200,
    min_success=0.97,
)
def test_feeds(tarl, tarl_drift):
    """Feed the filler for forty seconds: 0.075 for each bottle, a cost while it waits, -4 for fallen bottles."""
    hall = Hall(tarl.rng("hall"), **(tarl_drift or SHORT))
    tarl.start("bottle_conveyor.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("belt/speed"))
        tarl.reward(hall.gained)
    assert not hall.failure, hall.failure
