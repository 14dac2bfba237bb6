"""The car stops in time at the level of the calling floor; a step at the door costs reward."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.05
TIME_BOUND = 12.0
LEVEL = 0.03  # m
GRAVITY = 9.81


class Shaft:
    """A car on a rope with a counterweight that is `short` kg too light."""

    def __init__(self, rng, short):
        self.rng = rng
        self.mass = 900.0 + rng.uniform(-8.0, 8.0)
        self.missing = short + (self.mass - 900.0) * 0.5
        self.floor = int(rng.integers(1, 3))
        self.height = 0.0
        self.speed = 0.0
        self.time = 0.0
        self.level = 0
        self.failure = ""

    @property
    def arrived(self):
        """Return whether the doors were open for a second."""
        return self.level >= 20

    def publish(self, bus):
        """Publish the calling floor and the encoder count, in mm."""
        if self.time == 0.0:
            bus.publish("/call", UInt8(data=self.floor))
        bus.publish("/encoder", Float64(data=float(round(self.height * 1000.0 + self.rng.normal(0.0, 0.3)))))

    def advance(self, command):
        """Let motor and counterweight pull for one step."""
        force = command.data if command else 0.0
        total = force - self.missing * GRAVITY - 300.0 * self.speed
        self.speed += total / (2.0 * self.mass) * DT
        self.height += self.speed * DT
        self.time += DT
        off = abs(self.height - self.floor * 3.2)
        self.level = self.level + 1 if off <= LEVEL and abs(self.speed) < 0.05 else 0

    def judge(self):
        """Return the reward of the step, which grows as the remaining distance shrinks; arriving is worth most."""
        off = min(1.0, abs(self.height - self.floor * 3.2) / 6.4)
        if self.time > TIME_BOUND:
            self.failure = "never level with the floor"
            return -5.0
        return 10.0 if self.arrived else -0.02 * off


@pytest.mark.tarl(
    nodes=["lift.py"],
    sensors=[Sensor("height", topic="/encoder", field="data", low=0, high=6500, bins=13, unit="mm")],
    drifts={"light counterweight": 45.0},
    episodes=100,
    min_success=0.95,
)
def test_stops_level(tarl, tarl_drift):
    """Stop level with the floor."""
    shaft = Shaft(tarl.rng("shaft"), tarl_drift or 0.0)
    tarl.start("lift.py")
    while not (shaft.arrived or shaft.failure):
        shaft.publish(tarl.bus)
        tarl.step(DT)
        shaft.advance(tarl.bus.latest("/force"))
        tarl.reward(shaft.judge())
    assert shaft.arrived, shaft.failure
