"""A pasteuriser heats milk. With a longer holding tube, its thermometer is later, and the heat swings."""

from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Temperature = message_type("sensor_msgs/Temperature")

DT = 2.0
STEPS = 220
LEGAL = 72.0
BURNT = 78.0
RISE = 74.0  # temperature rise with a fully open valve (K)


class Plant:
    """A heater with a lag, and a holding tube of `delay` seconds behind it."""

    def __init__(self, rng, delay):
        self.rng = rng
        self.raw = rng.uniform(5.0, 7.0)
        self.drop = (rng.integers(60, 110), rng.uniform(2.5, 3.5))  # step of a colder tank, difference (K)
        self.power = rng.uniform(0.98, 1.02)
        self.heat = self.power * RISE * 0.0135 * (74.0 - self.raw)
        self.tube = deque([self.raw + self.heat] * (1 + round(delay / DT)))
        self.step = 0
        self.good, self.back = 0.0, 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the batch has ended."""
        return bool(self.failure) or self.step >= STEPS

    def publish(self, bus):
        """Publish the temperatures of the raw milk and of the milk behind the holding tube."""
        bus.publish("raw/temperature", Temperature(temperature=self.raw + self.rng.normal(0.0, 0.1)))
        bus.publish("holding/temperature", Temperature(temperature=self.tube[0] + self.rng.normal(0.0, 0.05)))

    def advance(self, steam, forward):
        """Heat for one step."""
        if self.step == self.drop[0]:
            self.raw -= self.drop[1]
        opening = steam.data if steam else 0.0
        self.heat += (self.power * RISE * opening - self.heat) * DT / 5.0
        self.tube.append(self.raw + self.heat + self.rng.normal(0.0, 0.1))
        leaves = self.tube.popleft()
        self.step += 1
        self.good = 0.0
        if forward is not None and forward.data:
            if leaves < LEGAL - 0.5:
                self.failure = "raw milk goes forward"
            self.good = 10.0 / STEPS * (1.0 - 0.05 * abs(leaves - 74.0))
        else:
            self.back += 1
        if leaves > BURNT:
            self.failure = "milk burns on"
        elif self.back > 30:
            self.failure = "too much milk goes back"

    def judge(self):
        """Return the reward of the step: milk that is sent on."""
        return self.good - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["milk_pasteuriser.py"],
    sensors=[
        Sensor(
            "hot", topic="holding/temperature", field="temperature", low=68.0, high=80.0, bins=8, unit="°C"
        ),
        Sensor("raw", topic="raw/temperature", field="temperature", low=2.0, high=8.0, bins=4, unit="°C"),
    ],
    drifts={"longer holding tube": 26.0},
    episodes=200,
    min_success=0.97,
)
def test_pasteurises(tarl, tarl_drift):
    """Pasteurise for seven minutes."""
    plant = Plant(tarl.rng("plant"), tarl_drift or 2.0)
    tarl.start("milk_pasteuriser.py")
    while not plant.done:
        plant.publish(tarl.bus)
        tarl.step(DT)
        plant.advance(tarl.bus.latest("steam/valve"), tarl.bus.latest("divert/forward"))
        tarl.reward(plant.judge())
    assert not plant.failure, plant.failure
