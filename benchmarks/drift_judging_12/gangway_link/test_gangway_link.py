"""A gangway follows the heave of a ship. In frost its oil is thick, the cylinder lags, and the tip bumps."""

import math
from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Temperature = message_type("sensor_msgs/msg/Temperature")
Vector3Stamped = message_type("geometry_msgs/msg/Vector3Stamped")

DT = 0.1
STEPS = 400
LANDING = 6.8
BUMP = 0.23  # m
LANDED = 6.0  # s


class Ship:
    """A ship in a swell with a gangway whose cylinder follows with a lag in seconds."""

    def __init__(self, rng, lag, celsius):
        self.rng = rng
        self.lag = lag * rng.uniform(0.96, 1.04)
        self.celsius = celsius + rng.uniform(-1.0, 1.0)
        self.swell = [
            (rng.uniform(0.62, 0.72), 2 * math.pi / rng.uniform(7.6, 8.4), rng.uniform(0.0, 6.28)),
            (rng.uniform(0.10, 0.14), 2 * math.pi / rng.uniform(5.6, 6.2), rng.uniform(0.0, 6.28)),
        ]
        self.angle = 0.08
        self.waiting = deque([0.08] * (1 + round(0.4 * self.lag / DT)))
        self.time, self.step = 0.0, 0
        self.crossed = 0.0
        self.bumps = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the transfer has ended."""
        return bool(self.failure) or self.step >= STEPS

    def heave(self):
        """Return heave and its rate."""
        level = sum(a * math.sin(w * self.time + p) for a, w, p in self.swell)
        rate = sum(a * w * math.cos(w * self.time + p) for a, w, p in self.swell)
        return level, rate

    def publish(self, bus):
        """Publish the motion of the ship and the temperature of the oil."""
        level, rate = self.heave()
        msg = Vector3Stamped()
        msg.vector.y = level + self.rng.normal(0.0, 0.01)
        msg.vector.z = rate + self.rng.normal(0.0, 0.02)
        bus.publish("mru/heave", msg)
        bus.publish("hydraulics/oil", Temperature(temperature=self.celsius + self.rng.normal(0.0, 0.2)))

    def advance(self, cmd, light):
        """Move the gangway for one step; people walk while the light is green."""
        self.waiting.append(cmd.data if cmd else self.angle)
        wanted = self.waiting.popleft()
        self.angle += (wanted - self.angle) * (1.0 - math.exp(-DT / (0.6 * self.lag)))
        self.time += DT
        self.step += 1
        tip = 6.0 + self.heave()[0] + 18.0 * math.sin(self.angle)
        self.crossed = 0.0
        if self.time > LANDED:
            error = abs(tip - LANDING)
            self.bumps += error > BUMP
            if light is not None and light.data:
                self.crossed = 10.0 / (STEPS - LANDED / DT) * (1.0 - 0.28 * min(1.0, (error / BUMP) ** 2))
        if self.bumps > 3:
            self.failure = "the tip bumps"

    def judge(self):
        """Return the reward of the step: people who walk over a quiet gangway."""
        return self.crossed - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["gangway_link.py", "kinematics.py"],
    sensors=[
        Sensor("oil", topic="hydraulics/oil", field="temperature", low=-20.0, high=40.0, bins=6, unit="°C"),
        Sensor("heave", topic="mru/heave", field="vector.y", low=-1.0, high=1.0, bins=4, unit="m"),
    ],
    drifts={"frost": {"lag": 0.70, "celsius": -9.0}},
    episodes=200,
    min_success=0.97,
)
def test_transfers(tarl, tarl_drift):
    """Let people walk over once."""
    ship = Ship(tarl.rng("ship"), **(tarl_drift or {"lag": 0.30, "celsius": 28.0}))
    tarl.start("gangway_link.py")
    while not ship.done:
        ship.publish(tarl.bus)
        tarl.step(DT)
        ship.advance(tarl.bus.latest("luff/angle"), tarl.bus.latest("light/green"))
        tarl.reward(ship.judge())
    assert not ship.failure, ship.failure
