"""A roller compacts a lane of asphalt. On a cold base course, the mat stiffens before the last pass."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Temperature = message_type("sensor_msgs/Temperature")

DT = 1.0
SUMMER = {"base": 24.0, "cooling": 1.0}
AUTUMN = {"base": 7.0, "cooling": 2.35}


class Lane:
    """A fresh lane on a base course of `base` degrees, that cools `cooling` times as fast as on a warm one."""

    def __init__(self, rng, base, cooling):
        self.rng = rng
        self.base = base + rng.normal(0.0, 1.0)
        self.rate = cooling / 880.0 * rng.normal(1.0, 0.03)  # 1/s
        self.bears = 141.0 + 12.0 * (cooling - 1.0)  # degrees; the lower half of the mat sets first
        self.surface = 161.0 + rng.normal(0.0, 1.5)
        self.voids = float(rng.uniform(14.5, 15.5))  # %
        self.position, self.speed, self.amplitude, self.dent = 0.5, 0.0, 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the roller is parked."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish what the roller's sensors measure."""
        seen = self.surface + self.rng.normal(0.0, 1.2)
        bus.publish("mat/temperature", Temperature(temperature=seen))
        bus.publish("roller/position", Float32(data=self.position + self.rng.normal(0.0, 0.05)))
        if round(self.time / DT) % 5 == 0:
            bus.publish("base/temperature", Temperature(temperature=self.base + self.rng.normal(0.0, 0.4)))

    def advance(self, twist, drum, state):
        """Roll for one step."""
        self.time += DT
        self.gained = -0.004
        self.speed = twist.linear.x if twist else 0.0
        self.amplitude = drum.data if drum else 0.0
        self.position += DT * self.speed
        self.surface -= DT * self.rate * (self.surface - self.base)
        if abs(self.speed) > 0.1:
            soft = 1.0 / (1.0 + math.exp((96.0 - self.surface) / 6.0))
            work = soft * (0.35 + self.amplitude) * abs(self.speed) * DT / 48.0
            less = min(self.voids, 0.225 * work * self.voids)
            self.voids -= less
            self.gained += 0.5 * less
            if self.surface > self.bears:
                self.failure = "mat shoves in front of the drum"
        if not -1.0 < self.position < 49.0:
            self.failure = "drum leaves the lane"
        elif self.time > 600.0:
            self.failure = "lane takes too long"
        elif state and state.data == "parked":
            self.over = True
            self.gained += 4.0 - 2.5 * max(0.0, self.voids - 6.5)
            if self.voids > 7.2:
                self.failure = "too many voids"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["asphalt_roller.py"],
    sensors=[
        Sensor("mat", topic="mat/temperature", field="temperature", low=60.0, high=160.0, bins=10, unit="C"),
        Sensor("base", topic="base/temperature", field="temperature", low=0.0, high=40.0, bins=8, unit="C"),
    ],
    drifts={"autumn": AUTUMN},
    episodes=200,
    min_success=0.97,
)
def test_compacts(tarl, tarl_drift):
    """Roll one lane."""
    lane = Lane(tarl.rng("lane"), **(tarl_drift or SUMMER))
    tarl.start("asphalt_roller.py")
    while not lane.done:
        lane.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        lane.advance(bus.latest("cmd_vel"), bus.latest("drum/amplitude"), bus.latest("roller/state"))
        tarl.reward(lane.gained)
    assert not lane.failure, lane.failure
