"""A machine deposits macarons. Batter that was whipped for longer holds more air, and its portions are too light.

Each row earns, less for portions beside 14 g, seconds cost a little, and a tray with three bad rows is a loss.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.2
AREA = 28.27  # cm2
DENSE = {"density": 1.12, "overrun": 18.0}  # g/ml, %
WHIPPED = {"density": 0.78, "overrun": 69.0}


class Line:
    """A depositor with batter of some `density`, that holds `overrun` percent of air."""

    def __init__(self, rng, density, overrun):
        self.rng = rng
        self.density = density * rng.normal(1.0, 0.015)
        self.overrun = overrun + rng.normal(0.0, 2.0)
        self.piston, self.speed = float(rng.uniform(0.0, 60.0)), 0.0
        self.gantry, self.moving = -1, 0.0
        self.pressed = [0.0] * 7  # g per row
        self.checked, self.bad = 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the tray is full or lost."""
        return bool(self.failure) or self.checked >= 7

    def publish(self, bus):
        """Publish piston, gantry and tray, and now and then what the mixer knows."""
        bus.publish("piston/position", Float32(data=self.piston + self.rng.normal(0.0, 0.05)))
        bus.publish("gantry/at", Int32(data=self.gantry if self.moving <= 0.0 else -1))
        step = round(self.time / DT)
        bus.publish("tray/present", Bool(data=step >= 3))
        if step % 10 == 0:
            bus.publish("mixer/overrun", Float32(data=self.overrun + self.rng.normal(0.0, 1.0)))

    def move(self, row):
        """Move the gantry to a row, and weigh the row before it."""
        if row != self.gantry:
            if self.gantry >= 0:
                self.weigh(self.gantry)
            self.gantry, self.moving = row, 0.8
        self.moving -= DT

    def weigh(self, row):
        """Weigh one row."""
        portion = self.pressed[row] / 8.0 * self.rng.normal(1.0, 0.015)
        off = abs(portion - 14.0)
        self.gained += 1.1 - 0.12 * off
        if off > 2.1:
            self.bad += 1
        self.checked += 1
        if self.bad >= 3:
            self.failure = "portions are wrong"

    def advance(self, row, speed, valve, state):
        """Work for one step."""
        self.time += DT
        self.gained = -0.001
        if row:
            self.move(row.data)
        self.speed += 0.7 * ((speed.data if speed else 0.0) - self.speed)
        way = DT * self.speed
        if way > 0.0 and self.gantry >= 0:
            self.pressed[self.gantry] += self.density * AREA * way / 10.0
        elif way < 0.0 and not (valve and valve.data):
            way = 0.0
        self.piston = max(0.0, min(130.0, self.piston + way))
        if state == "finished" and self.checked == self.gantry:
            self.weigh(self.gantry)
        if self.time > 90.0:
            self.failure = "batter dries"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["macaron_depositor.py"],
    sensors=[
        Sensor("overrun", topic="mixer/overrun", field="data", low=0.0, high=100.0, bins=8, unit="%"),
        Sensor("piston", topic="piston/position", field="data", low=0.0, high=130.0, bins=4, unit="mm"),
    ],
    drifts={"whipped": WHIPPED},
    episodes=200,
    min_success=0.97,
)
def test_deposits(tarl, tarl_drift):
    """Fill one tray: up to 1.1 for each row, a small cost per second, -4 for a lost tray."""
    line = Line(tarl.rng("line"), **(tarl_drift or DENSE))
    tarl.start("macaron_depositor.py")
    bus = tarl.bus
    while not line.done:
        line.publish(bus)
        tarl.step(DT)
        state = bus.latest("depositor/state")
        line.advance(
            bus.latest("gantry/row"),
            bus.latest("piston/speed"),
            bus.latest("hopper/valve"),
            state.data if state else "",
        )
        tarl.reward(line.gained)
    assert not line.failure, line.failure
