"""The rover reaches the end of its row between two hedges. After a repair, its compass is permanently twisted."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/PointStamped")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
LENGTH = 10.0
HEDGE = 0.9  # distance from the middle of the row (m)
TIME_BOUND = 30.0


class Orchard:
    """A row between hedges; the compass board is mounted at `mounting` degrees."""

    def __init__(self, rng, mounting):
        self.rng = rng
        self.mounting = mounting + rng.uniform(-2.0, 2.0)
        self.x, self.y = 0.0, rng.uniform(-0.2, 0.2)
        self.heading = rng.uniform(-0.2, 0.2)
        self.speed, self.turn = 0.0, 0.0
        self.gained = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def through(self):
        """Return whether the rover is at the end of the row."""
        return self.x >= LENGTH

    def publish(self, bus):
        """Publish GPS (RTK) and compass."""
        place = PointStamped()
        place.point.x = self.x + self.rng.normal(0.0, 0.03)
        place.point.y = self.y + self.rng.normal(0.0, 0.03)
        bus.publish("gps", place)
        reading = math.degrees(self.heading) - self.mounting - 3.5 + self.rng.normal(0.0, 1.0)
        bus.publish("compass", Float32(data=reading % 360.0))

    def advance(self, cmd):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += (max(0.0, min(1.0, speed)) - self.speed) * 0.4
        self.turn += (max(-1.0, min(1.0, turn)) - self.turn) * 0.5
        self.heading += self.turn * DT
        self.gained = self.speed * math.cos(self.heading) * DT
        self.x += self.gained
        self.y += self.speed * math.sin(self.heading) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress along the row."""
        if abs(self.y) > HEDGE:
            self.failure = "drove into the hedge"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return -6.0 if self.failure else 10.0 * self.gained / LENGTH - 0.005


@pytest.mark.tarl(
    nodes=["rover.py", "geo.py"],
    sensors=[
        Sensor("along", topic="gps", field="point.x", low=0, high=10, bins=8, unit="m"),
        Sensor("across", topic="gps", field="point.y", low=-1, high=1, bins=6, unit="m"),
    ],
    drifts={"twisted compass": Drift(50.0, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_reaches_the_end_of_the_row(tarl, tarl_drift):
    """Drive along one row."""
    orchard = Orchard(tarl.rng("orchard"), tarl_drift or 90.0)
    tarl.start("rover.py")
    while not (orchard.through or orchard.failure):
        orchard.publish(tarl.bus)
        tarl.step(DT)
        orchard.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(orchard.judge())
    assert orchard.through, orchard.failure
