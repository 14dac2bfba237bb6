"""A tunnel shrinks film around packs. On a generator the mains is low, and its heaters do not keep up with the belt.

Each pack with tight film earns, less for wrinkles; loose film or holes in several packs end the shift.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Temperature = message_type("sensor_msgs/msg/Temperature")

DT = 0.25
TUNNEL = 1.5  # m
GRID = {"mains": 231.0}
GENERATOR = {"mains": 178.0}  # V


class Line:
    """A tunnel on a grid with some voltage of its `mains`."""

    def __init__(self, rng, mains):
        self.rng = rng
        self.mains = mains + rng.normal(0.0, 1.5)
        self.room = 20.0 + rng.normal(0.0, 1.5)
        self.air = float(rng.uniform(135.0, 150.0))
        self.belt, self.ran = 0.0, 0.0
        self.packs = []  # way and temperature of the film
        self.next = 0.0
        self.count, self.bad, self.exit = 0, 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the packs are done."""
        return bool(self.failure) or self.count >= 12

    def publish(self, bus):
        """Publish the air, the mains every second, and the exit."""
        step = round(self.time / DT)
        bus.publish("tunnel/air", Temperature(temperature=self.air + self.rng.normal(0.0, 0.4)))
        if step % 4 == 0:
            bus.publish("cabinet/mains", Float32(data=self.mains + self.rng.normal(0.0, 1.0)))
        bus.publish("exit/blocked", Bool(data=self.exit > 0))
        self.exit = max(0, self.exit - 1)

    def judge(self, film):
        """Judge a pack by the temperature that its film had."""
        self.gained += 0.7 - 0.05 * max(0.0, abs(film - 118.5) - 10.5)
        if not 106.0 < film < 132.0:
            self.bad += 1
        self.count += 1
        self.exit = 3

    def advance(self, heat, belt, ready):
        """Run for one step."""
        self.time += DT
        self.gained = -0.0004
        duty = heat.data if heat else 0.0
        self.belt += 0.5 * ((belt.data if belt else 0.0) - self.belt)
        power = 12.0 * duty * (self.mains / 230.0) ** 2  # kW
        for _, film in self.packs:
            power -= 0.006 * (self.air - film)
        across = 1.0 - math.exp(-TUNNEL / (4.0 * max(0.02, self.belt)))
        power -= (0.03 + 0.175 * self.belt * across) * (self.air - self.room)
        self.air += DT * power / 0.5
        if ready and ready.data:
            self.ran += DT * self.belt
        if self.ran > 12.0:
            self.next -= DT * self.belt
            if self.next <= 0.0 and self.count + len(self.packs) < 12:
                self.packs.append([0.0, self.room])
                self.next = 0.6 + float(self.rng.uniform(0.0, 0.1))
        for pack in self.packs:
            pack[0] += DT * self.belt
            pack[1] += DT / 4.0 * (self.air - pack[1])
        while self.packs and self.packs[0][0] >= TUNNEL:
            self.judge(self.packs.pop(0)[1] + self.rng.normal(0.0, 0.6))
        if self.bad >= 3:
            self.failure = "packs are not tight"
        elif self.time > 190.0:
            self.failure = "line waits"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["shrink_tunnel.py"],
    sensors=[
        Sensor("air", topic="tunnel/air", field="temperature", low=100.0, high=190.0, bins=6, unit="C"),
        Sensor("mains", topic="cabinet/mains", field="data", low=150.0, high=260.0, bins=11, unit="V"),
    ],
    drifts={"generator": GENERATOR},
    episodes=200,
    min_success=0.97,
)
def test_shrinks(tarl, tarl_drift):
    """Shrink twelve packs: up to 0.7 for each, a small cost per second, -4 for three bad packs or a long wait."""
    line = Line(tarl.rng("line"), **(tarl_drift or GRID))
    tarl.start("shrink_tunnel.py")
    bus = tarl.bus
    while not line.done:
        line.publish(bus)
        tarl.step(DT)
        line.advance(bus.latest("tunnel/heat"), bus.latest("tunnel/belt"), bus.latest("tunnel/ready"))
        tarl.reward(line.gained)
    assert not line.failure, line.failure
