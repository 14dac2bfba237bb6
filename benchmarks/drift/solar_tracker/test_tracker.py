"""The panel points at the sun; each step is rewarded by the power, which is 0 far from the sun."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")

DT = 0.2
DURATION = 20.0
LOST = 0.6  # angle between panel and sun (rad)


class Roof:
    """A panel on a roof; from a random moment on, wind may turn it at `push` rad/s to either side."""

    def __init__(self, rng, push):
        self.rng = rng
        self.side = -1.0 if rng.random() < 0.5 else 1.0
        self.push = push * rng.uniform(0.95, 1.05)
        self.begin = rng.uniform(4.0, 8.0)
        self.sun = rng.uniform(0.5, 0.7)
        self.tilt = self.sun + rng.uniform(-0.3, 0.3)
        self.time = 0.0
        self.failure = ""

    @property
    def blowing(self):
        """Return the rate at which the wind turns the panel now, rad/s; the wind rises within a second."""
        return self.push * max(0.0, min(1.0, self.time - self.begin))

    def publish(self, bus):
        """Publish the measurements of weather station and encoder."""
        bus.publish("/wind", Float64(data=60.0 * self.blowing + abs(self.rng.normal(1.0, 0.5))))
        bus.publish("/sun", Float64(data=self.sun))
        bus.publish("/tilt", Float64(data=self.tilt + self.rng.normal(0.0, 0.003)))

    def advance(self, command):
        """Let the motor turn for one step."""
        speed = max(-0.6, min(0.6, command.data)) if command else 0.0
        self.tilt += (speed + self.side * self.blowing) * DT
        self.sun += 0.004 * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: the power of the panel."""
        off = abs(self.sun - self.tilt)
        if off > LOST:
            self.failure = "turned away from the sun"
            return -5.0
        return 0.1 * math.cos(2.0 * off)


@pytest.mark.tarl(
    nodes=["tracker.py"],
    sensors=[
        Sensor("wind", topic="/wind", field="data", low=0, high=25, bins=10, unit="m/s"),
        Sensor("tilt", topic="/tilt", field="data", low=0, high=1.2, bins=6, unit="rad"),
    ],
    drifts={"storm": 0.22},
    episodes=100,
    min_success=0.95,
)
def test_follows_the_sun(tarl, tarl_drift):
    """Never turn away from the sun."""
    roof = Roof(tarl.rng("roof"), tarl_drift or 0.0)
    tarl.start("tracker.py")
    while roof.time < DURATION and not roof.failure:
        roof.publish(tarl.bus)
        tarl.step(DT)
        roof.advance(tarl.bus.latest("/motor"))
        tarl.reward(roof.judge())
    assert not roof.failure, roof.failure
