"""A wagon rolls to the standing wagons and couples; only the coupling is rewarded. In frost its bearings roll worse."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")

BRAKING = 0.1  # length of a step while the wagon is in the retarder (s)
ROLLING = 1.0  # length of a step after the wagon has left the retarder (s)
COUPLES = (0.35, 2.0)  # m/s
G = 9.81
FALL = 0.0006


class Yard:
    """A rolling wagon; its rolling resistance is about `resistance` times its weight."""

    def __init__(self, rng, resistance):
        self.rng = rng
        frost = resistance > 0.003
        self.air = rng.uniform(-14.0, -4.0) if frost else rng.uniform(6.0, 26.0)
        self.resistance = resistance * rng.uniform(0.97, 1.03)
        self.speed = rng.uniform(5.6, 6.2)
        self.free = rng.uniform(60.0, 110.0)
        self.left = self.free
        self.rolls = False
        self.arrived = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the wagon has coupled or can no longer couple."""
        return self.arrived or bool(self.failure)

    @property
    def dt(self):
        """Return the length of the next step: s."""
        return ROLLING if self.rolls else BRAKING

    def publish(self, bus):
        """Publish free track and temperature, and, inside the retarder, the radar."""
        bus.publish("yard/air", Float64(data=self.air + self.rng.normal(0.0, 0.2)))
        bus.publish("track/free", Float64(data=self.free))
        if not self.rolls:
            bus.publish("radar/speed", Float64(data=self.speed + self.rng.normal(0.0, 0.015)))

    def advance(self, pressure, released):
        """Brake, or roll for one step."""
        dt = self.dt
        if not self.rolls:
            bar = max(0.0, min(8.0, pressure.data)) if pressure else 0.0
            self.speed = max(0.0, self.speed - 0.25 * bar * dt)
            self.rolls = bool(released and released.data)
            if self.speed <= 0.3 and not self.rolls:
                self.failure = "stopped in the retarder"
            return
        before = self.speed
        self.speed -= G * (self.resistance - FALL) * dt
        way = (before + max(0.0, self.speed)) / 2.0 * dt
        if way >= self.left:
            self.arrived = True
            slow, fast = COUPLES
            if not slow < self.speed < fast:
                self.failure = f"hits the other wagons at {self.speed:.1f} m/s"
        elif self.speed <= 0.0:
            self.failure = f"stopped {self.left - way:.0f} m before the other wagons"
        self.left -= way

    def judge(self):
        """Return the reward of the step, which is 0 before the wagon has arrived."""
        if self.failure:
            return -5.0
        return 10.0 - 2.0 * abs(self.speed - 1.1) if self.arrived else 0.0


@pytest.mark.tarl(
    nodes=["retarder.py"],
    sensors=[
        Sensor("air", topic="yard/air", field="data", edges=(0.0,), unit="°C"),
        Sensor("free", topic="track/free", field="data", low=60, high=110, bins=3, unit="m"),
    ],
    drifts={"frost": 0.0042},
    episodes=100,
    min_success=0.95,
)
def test_couples(tarl, tarl_drift):
    """Sort one wagon."""
    yard = Yard(tarl.rng("yard"), tarl_drift or 0.0022)
    tarl.start("retarder.py")
    while not yard.done:
        yard.publish(tarl.bus)
        tarl.step(yard.dt)
        yard.advance(tarl.bus.latest("retarder/pressure"), tarl.bus.latest("retarder/released"))
        tarl.reward(yard.judge())
    assert not yard.failure, yard.failure
