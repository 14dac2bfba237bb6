"""A weir holds the level of a pond. In a gale waves reach the gauge, the gate never rests, and its motor gets hot.

Each step earns, less beside the wanted level; a motor that trips, a flood and a dry mill are losses.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 4.0  # s
CALM = {"waves": 0.0003}
GALE = {"waves": 0.03}  # m
STEPS = 300


class Pond:
    """A pond of 300 m2 with waves of some height at its gauge."""

    def __init__(self, rng, waves):
        self.rng = rng
        self.waves = waves * rng.normal(1.0, 0.03)
        self.level = 1.5 + float(rng.uniform(-0.03, 0.03))
        self.gate = float(rng.uniform(0.2, 0.3))
        self.inflow = 0.9  # m3/s
        self.change = rng.integers(40, 90)
        self.heat = 0.0  # of the motor's winding, trips at 1
        self.turning = 0
        self.step, self.gained, self.failure = 0, 0.0, ""

    @property
    def done(self):
        """Return whether the watch is over."""
        return bool(self.failure) or self.step >= STEPS

    def publish(self, bus):
        """Publish gauge, gate, and now and then the rain."""
        bus.publish("pond/level", Float32(data=self.level + self.rng.normal(0.0, self.waves)))
        bus.publish("gate/position", Float32(data=self.gate + self.rng.normal(0.0, 0.0004)))
        if self.step % 15 == 0:
            bus.publish("weather/rain", Float32(data=max(0.0, 40.0 * (self.inflow - 0.9))))

    def turn(self, command):
        """Turn the motor of the gate; each start and each reversal heats it."""
        speed = max(-1.0, min(1.0, command)) if abs(command) > 0.002 else 0.0
        now = (speed > 0.0) - (speed < 0.0)
        if now and now != self.turning:
            self.heat += 0.08
        self.heat += DT * (0.0004 * abs(now) - self.heat / 120.0)
        self.turning = now
        self.gate = max(0.0, min(1.0, self.gate + DT * 0.1 * speed))

    def advance(self, motor):
        """Let the water flow for one step."""
        self.step += 1
        self.gained = 0.03
        if self.step % self.change == 0:
            self.inflow = float(self.rng.uniform(0.6, 1.3))
        self.turn(motor.data if motor else 0.0)
        outflow = 0.62 * 1.1 * self.gate * (2.0 * 9.81 * max(0.0, self.level)) ** 0.5
        self.level += DT * (self.inflow - outflow) / 300.0
        off = abs(self.level - 1.5)
        self.gained -= 0.1 * max(0.0, off - 0.06)
        if self.heat > 1.0:
            self.failure = "motor trips"
        elif off > 0.25:
            self.failure = "level is lost"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["pond_weir.py"],
    sensors=[
        Sensor("level", topic="pond/level", field="data", low=1.3, high=1.7, bins=8, unit="m"),
        Sensor("gate", topic="gate/position", field="data", low=0.0, high=0.9, bins=6, unit="m"),
    ],
    drifts={"gale": GALE},
    episodes=200,
    min_success=0.97,
)
def test_holds(tarl, tarl_drift):
    """Hold the level for twenty minutes: up to 0.03 per step, -4 for a motor that trips."""
    pond = Pond(tarl.rng("pond"), **(tarl_drift or CALM))
    tarl.start("pond_weir.py")
    while not pond.done:
        pond.publish(tarl.bus)
        tarl.step(DT)
        pond.advance(tarl.bus.latest("gate/motor"))
        tarl.reward(pond.gained)
    assert not pond.failure, pond.failure
