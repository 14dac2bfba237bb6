"""A machine winds pressure vessels. Thin ones turn four times as fast, and the carriage falls behind their pattern.

Each step earns, less for fibres beside their place; a carriage that stays beside it fails.
"""

import math
from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Vector3Stamped = message_type("geometry_msgs/Vector3Stamped")

DT = 0.05
LENGTH, PITCH = 0.8, 0.2  # m, m per turn
THICK = {"rate": 0.15}
THIN = {"rate": 0.62}  # turns per s


class Machine:
    """A machine whose mandrel turns at some `rate`."""

    def __init__(self, rng, rate):
        self.rng = rng
        self.rate = rate * rng.normal(1.0, 0.015)
        self.turns, self.at, self.speed = 0.0, 0.0, 0.0
        self.offset = float(rng.uniform(0.0, 6.28))
        self.lag = 0.12 * rng.normal(1.0, 0.05)  # s
        self.commands = deque([0.0] * 5, maxlen=5)  # of the drive's bus
        self.started, self.beside = False, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the shift is over."""
        return bool(self.failure) or self.time >= 22.0

    def publish(self, bus):
        """Publish mandrel and carriage, the tension twice a second, and once the start."""
        step = round(self.time / DT)
        mandrel = Vector3Stamped()
        mandrel.vector.x = (2.0 * math.pi * self.turns + self.offset) % (2.0 * math.pi)
        mandrel.vector.y = 3.0 + self.rng.normal(0.0, 0.1)
        bus.publish("mandrel/state", mandrel)
        bus.publish("carriage/position", Float32(data=self.at + self.rng.normal(0.0, 0.0005)))
        if step % 10 == 0:
            bus.publish("eyelet/tension", Float32(data=20.0 + self.rng.normal(0.0, 1.0)))
        if step == 10:
            bus.publish("panel/start", Bool(data=True))
            self.started = True

    def wanted(self):
        """Return the place of the pattern in m."""
        way = (self.turns * PITCH) % (2.0 * LENGTH)
        return way if way < LENGTH else 2.0 * LENGTH - way

    def advance(self, command, stop):
        """Wind for one step."""
        self.time += DT
        self.gained = 0.0
        self.speed += DT / self.lag * (self.commands[0] - self.speed)
        self.commands.append(command.data if command else 0.0)
        self.at += DT * self.speed
        if self.started:
            self.turns += DT * self.rate
        wanted = self.wanted()
        if self.time > 3.0:
            self.gained = 0.025
            if 0.14 < wanted < LENGTH - 0.14:  # not on the domes
                off = abs(self.at - wanted)
                self.gained -= 0.8 * max(0.0, off - 0.018)
                self.beside = self.beside + DT if off > 0.03 else 0.0
        if self.beside > 0.8:
            self.failure = "fibres lie beside the pattern"
        elif stop:
            self.failure = "machine stops"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["filament_winder.py"],
    sensors=[
        Sensor("place", topic="carriage/position", field="data", low=0.0, high=0.8, bins=8, unit="m"),
        Sensor("tension", topic="eyelet/tension", field="data", low=0.0, high=40.0, bins=4, unit="N"),
    ],
    drifts={"thin": THIN},
    episodes=200,
    min_success=0.97,
)
def test_winds(tarl, tarl_drift):
    """Wind for twenty seconds: reward for each step, less for fibres beside their place, -4 for a lost pattern."""
    machine = Machine(tarl.rng("machine"), **(tarl_drift or THICK))
    tarl.start("filament_winder.py", launch="winder.launch")
    while not machine.done:
        machine.publish(tarl.bus)
        tarl.step(DT)
        machine.advance(tarl.bus.latest("carriage/speed"), tarl.bus.latest("winder/stop"))
        tarl.reward(machine.gained)
    assert not machine.failure, machine.failure
