"""A tractor pulls a machine that plants seedlings. On a large field it drives four times as fast.

A seedling in its hole earns, less beside the middle of the hole; two holes without a seedling end the row.
"""

from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
SMALL = {"speed": 0.08}  # m/s
LARGE = {"speed": 0.32}
HOLES = 3
APART = 0.55  # m


class Field:
    """A row of holes under a machine that drives at some `speed`."""

    def __init__(self, rng, speed):
        self.rng = rng
        self.speed = speed * rng.normal(1.0, 0.02)
        self.pace = self.speed
        self.carriage, self.rate = 0.2, 0.0
        self.lag = 0.15 * rng.normal(1.0, 0.05)  # s
        start = float(rng.uniform(0.35, 0.45))
        self.holes = [start + APART * number for number in range(HOLES)]  # places relative to the machine
        self.seen = deque([None] * 4, maxlen=4)  # camera's pictures
        self.reload = 0.5  # s until the cup is full
        self.drops, self.planted, self.missed = 0, 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the row is over."""
        return bool(self.failure) or not self.holes

    def publish(self, bus):
        """Publish tractor, carriage, cup and the camera's picture."""
        bus.publish("tractor/speed", Float32(data=self.pace + self.rng.normal(0.0, 0.003)))
        bus.publish("carriage/position", Float32(data=self.carriage + self.rng.normal(0.0, 0.001)))
        bus.publish("cup/loaded", Bool(data=self.reload <= 0.0))
        offset = self.holes[0] - self.carriage
        self.seen.append(offset + self.rng.normal(0.0, 0.002) if abs(offset) < 0.4 else None)
        if self.seen[0] is not None:
            bus.publish("camera/hole", Float32(data=self.seen[0]))

    def advance(self, command):
        """Drive for one step."""
        self.time += DT
        self.gained = 0.0
        self.reload -= DT
        self.pace += 0.1 * (self.speed - self.pace) + self.rng.normal(0.0, 0.003)
        self.rate += DT / self.lag * ((command.data if command else 0.0) - self.rate)
        self.carriage = max(-0.4, min(0.4, self.carriage + DT * self.rate))
        self.holes = [hole - DT * self.pace for hole in self.holes]
        if self.drops and self.reload <= 0.0:
            off = abs(self.holes[0] - self.carriage)
            if off < 0.06:
                self.gained += 2.9 - 3.0 * off
                self.planted += 1
                self.holes.pop(0)
            else:
                self.missed += 1
                self.gained -= 0.3
            self.reload = 0.6
        elif self.holes[0] < -0.4:
            self.holes.pop(0)
            self.missed += 1
        self.drops = 0
        if self.missed >= 2:
            self.failure = "holes stay empty"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["seedling_planter.py"],
    sensors=[
        Sensor("hole", topic="camera/hole", field="data", low=-0.4, high=0.4, bins=8, unit="m"),
        Sensor("speed", topic="tractor/speed", field="data", low=0.0, high=0.4, bins=6, unit="m/s"),
    ],
    drifts={"large": LARGE},
    episodes=200,
    min_success=0.97,
)
def test_plants(tarl, tarl_drift):
    """Plant one row of three: up to 2.9 for each, -4 for two empty holes."""
    field = Field(tarl.rng("field"), **(tarl_drift or SMALL))
    tarl.start("seedling_planter.py")
    tarl.bus.subscribe("cup/drop", lambda _: setattr(field, "drops", field.drops + 1))
    while not field.done:
        field.publish(tarl.bus)
        tarl.step(DT)
        field.advance(tarl.bus.latest("carriage/speed"))
        tarl.reward(field.gained)
    assert not field.failure, field.failure
