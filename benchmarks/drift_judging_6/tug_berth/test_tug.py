"""A tug pushes a barge to the quay, which the barge touches gently. An offshore gale is stronger than the tug."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Range = message_type("sensor_msgs/msg/Range")

DT = 0.25
MASS, DRAG = 3.0, 1.2  # relative to the tug's full thrust: s^2/m and s/m
GENTLE = 0.2  # m/s
LOST = 16.0  # distance from the quay (m)
TIME_BOUND = 70.0


class Harbour:
    """A barge between a tug and a quay."""

    def __init__(self, rng, gale):
        self.rng = rng
        self.mean = gale if gale else rng.uniform(0.1, 0.35)
        self.wind = self.mean
        self.distance = self.start = rng.uniform(8.0, 11.0)
        self.speed = self.moved = self.time = 0.0
        self.failure = ""

    @property
    def alongside(self):
        """Return whether the barge touches the quay."""
        return self.distance <= 0.0

    @property
    def done(self):
        """Return whether the manoeuvre is over."""
        return self.alongside or bool(self.failure)

    def publish(self, bus):
        """Publish the distance to the quay and the wind, in m/s."""
        bus.publish("quay/range", Range(range=max(0.0, self.distance + self.rng.normal(0.0, 0.01))))
        bus.publish("mast/wind", Float32(data=16.0 * self.wind**0.5 + self.rng.normal(0.0, 0.3)))

    def advance(self, thrust):
        """Push for one step."""
        self.time += DT
        self.wind = max(0.0, self.wind + 0.1 * (self.mean - self.wind) + self.rng.normal(0.0, 0.01))
        push = max(-1.0, min(1.0, thrust.data if thrust else 0.0))
        self.speed += (push - self.wind - DRAG * self.speed) / MASS * DT
        self.moved = self.speed * DT
        self.distance -= self.moved

    def judge(self):
        """Return the reward of the step: 4 for progress, 6 for a gentle touch, minus a cost of time."""
        if self.alongside and self.speed > GENTLE:
            self.failure = f"touched at {self.speed:.2f} m/s"
        elif self.distance > LOST:
            self.failure = "the barge drifts away"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        if self.failure:
            return -5.0
        return 4.0 * self.moved / self.start + 6.0 * self.alongside - 0.002


@pytest.mark.tarl(
    nodes=["tug.py"],
    sensors=[
        Sensor("wind", topic="mast/wind", field="data", edges=(5.0, 10.0, 14.0), unit="m/s"),
        Sensor("distance", topic="quay/range", field="range", low=0, high=15, bins=5, unit="m"),
    ],
    drifts={"offshore gale": 1.15},
    episodes=80,
    min_success=0.95,
)
def test_berths(tarl, tarl_drift):
    """Bring one barge alongside."""
    harbour = Harbour(tarl.rng("harbour"), tarl_drift)
    tarl.start("tug.py")
    while not harbour.done:
        harbour.publish(tarl.bus)
        tarl.step(DT)
        harbour.advance(tarl.bus.latest("thruster"))
        tarl.reward(harbour.judge())
    assert not harbour.failure, harbour.failure
