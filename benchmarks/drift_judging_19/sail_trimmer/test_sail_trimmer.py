"""A small boat sails to a mark. Its wind vane broke, and the new one sends degrees instead of radians."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Point = message_type("geometry_msgs/Point")

DT = 0.25
RADIANS, DEGREES = 1.0, 180.0 / math.pi


def wrap(angle):
    """Return an angle between -pi and pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


class Water:
    """A boat 60 m off a mark; its vane sends the angle of the wind in a unit."""

    def __init__(self, rng, unit):
        self.rng = rng
        self.unit = unit
        close = rng.random() < 0.5
        wind = rng.uniform(0.95, 1.15) if close else rng.uniform(2.3, 2.8)
        self.wind = float(rng.choice((-1.0, 1.0)) * wind)  # rad off the course to the mark
        self.strength = float(rng.uniform(0.85, 1.1))
        self.gust = 0.0
        self.x, self.y, self.heading, self.turn = 0.0, 0.0, float(rng.normal(0.0, 0.1)), 0.0
        self.speed, self.boom, self.heel = 1.0, 0.6, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def off(self):
        """Return the angle of the wind off the bow, in rad."""
        return wrap(self.wind - self.heading)

    @property
    def done(self):
        """Return whether the boat is at the mark, or something went wrong."""
        return bool(self.failure) or self.left < 6.0

    @property
    def left(self):
        """Return the way to the mark, in m."""
        return math.hypot(60.0 - self.x, self.y)

    def publish(self, bus):
        """Publish the vane, the compass, the heel and the position."""
        vane = wrap(self.off + self.rng.normal(0.0, 0.05))
        bus.publish("wind/angle", Float32(data=self.unit * vane))
        bus.publish("compass", Float32(data=wrap(self.heading + self.rng.normal(0.0, 0.01))))
        bus.publish("heel", Float32(data=self.heel + self.rng.normal(0.0, 0.01)))
        bus.publish("gps/local", Point(x=self.x + self.rng.normal(0.0, 0.2), y=self.y))
        bus.publish("mark", Point(x=60.0, y=0.0))

    def advance(self, boom, rudder):
        """Sail for one step; a sail drives well near its best angle, flaps when eased, and stalls when hauled."""
        self.boom += 0.3 * ((boom.data if boom else 0.6) - self.boom)
        self.gust += 0.1 * (self.rng.normal(0.0, 0.25) - self.gust)
        blow = max(0.3, self.strength + self.gust)
        off = abs(self.off)
        best = max(0.1, min(1.35, 0.62 * (off - 0.32)))
        trim = (self.boom - best) / (0.3 if self.boom > best else 0.34)
        drive = math.exp(-(trim**2)) * min(1.0, max(0.0, (off - 0.45) / 0.5))
        self.speed += 0.12 * (2.4 * blow * drive - self.speed)
        self.heel = 0.35 * blow * blow * math.sin(off) * max(0.0, 1.0 - 0.5 * max(0.0, trim))
        tiller = (rudder.data if rudder else 0.0) * (0.3 + 0.5 * self.speed)
        self.turn += 0.4 * (tiller - self.turn)
        self.heading = wrap(self.heading + DT * self.turn)
        before = self.left
        self.x += DT * self.speed * math.cos(self.heading)
        self.y += DT * self.speed * math.sin(self.heading)
        self.time += DT
        self.gained = 0.1 * (before - self.left) - 0.008
        if self.time > 34.0:
            self.failure = f"boat is {self.left:.0f} m off the mark"
            self.gained -= 4.0
        elif abs(self.y) > 25.0:
            self.failure = "boat runs aground"
            self.gained -= 4.0
        elif self.left < 6.0:
            self.gained += 2.0


@pytest.mark.tarl(
    nodes=["sail_trimmer.py"],
    sensors=[
        Sensor("wind", topic="wind/angle", field="data", low=-3.2, high=3.2, bins=6, unit="rad"),
        Sensor("boom", topic="boom/angle", field="data", low=0.0, high=1.4, bins=4, unit="rad"),
    ],
    drifts={"new vane": Drift(DEGREES, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_sails(tarl, tarl_drift):
    """Sail to the mark on one tack."""
    water = Water(tarl.rng("water"), tarl_drift or RADIANS)
    tarl.start("sail_trimmer.py")
    while not water.done:
        water.publish(tarl.bus)
        tarl.step(DT)
        water.advance(tarl.bus.latest("boom/angle"), tarl.bus.latest("rudder/angle"))
        tarl.reward(water.gained)
    assert not water.failure, water.failure
