"""A road gets the right grams of salt per square metre. The spreader moves from a cycle path to a road with traffic."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.5
STEPS = 60
WINDOW = 0.22  # tolerated relative error of the salt


class Road:
    """A road, a vehicle at the speed of its driver and a hopper of salt."""

    def __init__(self, rng, traffic):
        self.rng = rng
        self.traffic = traffic
        self.cold = rng.uniform(2.0, 7.0)
        self.phase = rng.uniform(0.0, 6.28)
        self.period = rng.uniform(16.0, 28.0)
        self.step = self.good = 0

    @property
    def speed(self):
        """Return the vehicle's speed in m/s."""
        if not self.traffic:
            return 4.0 + 0.15 * math.sin(self.phase + self.step * DT)
        return 7.5 + 4.8 * math.sin(self.phase + 6.28 * self.step * DT / self.period)

    @property
    def temperature(self):
        """Return the temperature of the road."""
        return -self.cold - 0.8 * math.sin(self.step * DT / 9.0)

    def publish(self, bus):
        """Publish the road's temperature and the wheel's speed."""
        bus.publish("road/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 0.1)))
        bus.publish("vehicle/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.03)))

    def advance(self, gate):
        """Spread one step and return its reward."""
        first = self.step < 3  # the node's filter settles
        if gate is None:
            self.step += 1
            return 0.0
        needed = 10.0 + 1.25 * max(0.0, -self.temperature)  # g/m2
        spread = 250.0 * max(0.0, min(1.0, gate.data)) / self.speed * self.rng.normal(1.0, 0.02)
        self.step += 1
        off = abs(spread / needed - 1.0)
        if off < WINDOW or first:
            self.good += 1
            return 10.0 / STEPS * (1.0 - 0.3 * min(1.0, off / WINDOW))
        return -4.0 / STEPS


@pytest.mark.tarl(
    nodes=["spreader.py"],
    sensors=[
        Sensor("speed", topic="vehicle/speed", field="data", low=2, high=13, bins=6, unit="m/s"),
        Sensor("road", topic="road/temperature", field="data", low=-8, high=-2, bins=3, unit="°C"),
    ],
    drifts={"traffic": True},
    episodes=100,
    min_success=0.95,
)
def test_spreads(tarl, tarl_drift):
    """Salt one road."""
    road = Road(tarl.rng("road"), bool(tarl_drift))
    tarl.start("spreader.py")
    for _ in range(STEPS):
        road.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(road.advance(tarl.bus.latest("/spreader/gate")))
    assert road.good >= 0.85 * STEPS, f"{road.good} of {STEPS} parts of the road got their salt"
