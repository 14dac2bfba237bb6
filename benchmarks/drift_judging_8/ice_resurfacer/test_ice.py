"""A resurfacer lays an even film of water. In the old hall the water is hard, and scale narrows the nozzles."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Odometry = message_type("nav_msgs/msg/Odometry")

DT = 0.4
STEPS = 60
FILM = 0.16  # mm
BAND = 0.17  # relative error of the film that skaters do not feel
OPENINGS = (0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0)
FLOWS = (0.0, 4.1, 9.0, 17.6, 26.5, 37.0, 48.0)


def bar(opening):
    """Return the flow of new nozzles in l/min."""
    for low, high, start, end in zip(OPENINGS, OPENINGS[1:], FLOWS, FLOWS[1:], strict=False):
        if opening <= high:
            return start + (opening - low) / (high - low) * (end - start)
    return FLOWS[-1]


class Rink:
    """Laps on a rink."""

    def __init__(self, rng, scale):
        self.rng = rng
        self.scale = scale * rng.uniform(0.98, 1.02)
        self.hard = scale < 0.9
        self.cruise, self.phase = rng.uniform(1.0, 1.25), rng.uniform(0.0, 6.28)
        self.step = self.good = 0

    @property
    def speed(self):
        """Return the speed of the driver in m/s."""
        return self.cruise + 0.2 * math.sin(self.phase + 0.2 * self.step)

    def publish(self, bus):
        """Publish odometry, the tank level and the conductivity of the water."""
        odom = Odometry()
        odom.twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.01)
        odom.twist.twist.angular.z = max(0.0, 0.5 * math.sin(self.phase + 0.35 * self.step))
        bus.publish("water/conductivity", Float64(data=(780 if self.hard else 210) + self.rng.normal(0, 25)))
        bus.publish("water/tank_percent", Float64(data=100.0 - self.step))
        bus.publish("odom", odom)

    def advance(self, valve):
        """Lay one step of film and return its reward."""
        self.step += 1
        if valve is None:
            return 0.0
        flow = self.scale * bar(min(1.0, max(0.0, valve.data))) * self.rng.normal(1.0, 0.015)
        off = abs(flow / 60.0 / (2.13 * self.speed) / FILM - 1.0)
        if off < BAND or self.step < 5:  # the node's filter settles
            self.good += 1
            return 10.0 / STEPS * (1.0 - 0.25 * min(1.0, off / BAND))
        return -10.0 / STEPS * min(1.0, off)


@pytest.mark.tarl(
    nodes=["resurfacer.py", "nozzles.py"],
    sensors=[
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=0.7, high=1.5, bins=4, unit="m/s"),
        Sensor("conductivity", topic="water/conductivity", field="data", edges=(500.0,), unit="uS/cm"),
    ],
    drifts={"hard water": 0.66},
    episodes=100,
    min_success=0.95,
)
def test_floods(tarl, tarl_drift):
    """Flood the rink once."""
    rink = Rink(tarl.rng("rink"), tarl_drift or 1.0)
    tarl.start("resurfacer.py")
    for _ in range(STEPS):
        rink.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(rink.advance(tarl.bus.latest("water/valve")))
    assert rink.good >= 0.85 * STEPS, f"{rink.good} of {STEPS} steps got their film"
