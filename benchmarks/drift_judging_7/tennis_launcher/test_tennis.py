"""Balls land on their spot and cross the net within a window. Foam balls for children have much more drag."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
String = message_type("std_msgs/msg/String")

DT = 0.5
SHOTS = 12
NET = 7.0  # distance from the machine (m)
DRAG = {"felt": 0.022, "foam": 0.085}  # 1/m
NEAR = 1.3  # distance from the spot (m)
LOW, HIGH = 2.5, 3.3  # heights above the net line (m)


def flight(speed, elevation, drag):
    """Return the landing place of a ball and its height at the net, in m."""
    vx, vy = speed * math.cos(elevation), speed * math.sin(elevation)
    x, y, h, height = 0.0, 0.6, 0.02, 0.0
    while y > 0.0 and x < 40.0:
        v = math.hypot(vx, vy)
        vx -= drag * v * vx * h
        vy -= (9.81 + drag * v * vy) * h
        if x < NET <= x + vx * h:
            height = y
        x, y = x + vx * h, y + vy * h
    return x, height


class Court:
    """A court on which a trainer requests spots."""

    def __init__(self, rng, balls):
        self.rng = rng
        self.balls = balls
        self.spot = rng.uniform(13.0, 15.0)
        self.hits = 0
        self.shot = 0

    def publish(self, bus):
        """Publish the spot and the kind of balls in the hopper."""
        bus.publish("hopper/balls", String(data=self.balls))
        bus.publish("tablet/spot", Float64(data=self.spot))

    def advance(self, shot):
        """Shoot a ball and return its reward."""
        self.shot += 1
        if shot is None:
            return -0.5
        speed = max(0.0, shot.x) * 0.93 * 0.11 * (1.0 + self.rng.normal(0.0, 0.008))
        elevation = math.radians(min(80.0, max(0.0, shot.y)) + self.rng.normal(0.0, 0.3))
        x, height = flight(speed, elevation, DRAG[self.balls] * self.rng.uniform(0.97, 1.03))
        off = abs(x - self.spot)
        over = LOW < height < HIGH
        self.hits += off < NEAR and over
        self.spot = self.rng.uniform(13.0, 15.0)
        return 10.0 / SHOTS * ((off < NEAR) * (0.6 - 0.2 * off / NEAR) + 0.5 * over - 0.1) - 0.5 * (
            off > 2 * NEAR
        )


@pytest.mark.tarl(
    nodes=["launcher.py"],
    sensors=[
        Sensor("balls", topic="hopper/balls", field="data", categories=("felt", "foam")),
        Sensor("spot", topic="tablet/spot", field="data", low=12, high=16, bins=4, unit="m"),
    ],
    drifts={"foam balls": "foam"},
    episodes=100,
    min_success=0.95,
)
def test_serves(tarl, tarl_drift):
    """Serve twelve balls."""
    court = Court(tarl.rng("court"), tarl_drift or "felt")
    tarl.start("launcher.py")
    for _ in range(SHOTS):
        court.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(court.advance(tarl.bus.latest("launcher/shot")))
    assert court.hits >= SHOTS - 2, f"{court.hits} of {SHOTS} balls were good"
