"""An incubator hatches eggs. The thermistor was replaced by one with another characteristic, for good."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
RelativeHumidity = message_type("sensor_msgs/RelativeHumidity")
UInt16 = message_type("std_msgs/UInt16")

DT = 10.0
MINUTES = 130.0
BEST = ((0.0, 37.7), (60.0, 37.2), (100.0, 36.8))  # minutes, °C
MAY_MISS = 1.0  # mean error over a few minutes (K)


class Box:
    """A heated box with a thermistor, a mist nozzle and eggs, which follow the air slowly."""

    def __init__(self, rng, beta):
        self.rng = rng
        self.beta = beta * rng.uniform(0.997, 1.003)
        self.room = rng.uniform(19.0, 24.0)
        self.celsius = rng.uniform(37.4, 38.0)
        self.eggs = self.celsius
        self.wet = rng.uniform(0.5, 0.58)
        self.side, self.turns = None, 0
        self.time = 0.0
        self.failure = ""

    @property
    def minutes(self):
        """Return the minutes since the start."""
        return self.time / 60.0

    @property
    def done(self):
        """Return whether the eggs hatched, or the episode has failed."""
        return self.minutes >= MINUTES or bool(self.failure)

    def publish(self, bus):
        """Publish the converter's counts and the humidity."""
        inverse = 1.0 / (self.celsius + 273.15) - 1.0 / 298.15
        ohm = 10000.0 * math.exp(self.beta * inverse)
        counts = 4095.0 * ohm / (ohm + 10000.0) + self.rng.normal(0.0, 2.0)
        bus.publish("thermistor/counts", UInt16(data=round(counts)))
        bus.publish("air/humidity", RelativeHumidity(relative_humidity=self.wet))

    def advance(self, duty, mist, side):
        """Heat, moisten and turn for one step."""
        self.time += DT
        heat = duty.data if duty else 0.5
        self.celsius += DT * (0.05 * heat - 0.0016 * (self.celsius - self.room)) + self.rng.normal(0.0, 0.02)
        self.eggs += DT / 150.0 * (self.celsius - self.eggs)
        self.wet += 0.02 * ((0.8 if mist and mist.data else 0.45) - self.wet)
        if side and side.data != self.side:
            self.side = side.data
            self.turns += 1

    def judge(self):
        """Return the reward of the step: minutes are rewarded, more near the best temperature."""
        best = [celsius for begin, celsius in BEST if self.minutes >= begin][-1]
        off = (self.eggs - best) / MAY_MISS
        if abs(off) > 1.0:
            self.failure = "the embryos are dead"
        elif self.done and self.turns < 3:
            self.failure = "the embryos stick to the shells"
        return -5.0 if self.failure else 10.0 * DT / 60.0 / MINUTES * (1.0 - off**2)


@pytest.mark.tarl(
    nodes=["egg_incubator.py", "thermistor.py"],
    sensors=[
        Sensor("counts", topic="thermistor/counts", field="data", low=1400.0, high=1700.0, bins=4),
        Sensor("humidity", topic="air/humidity", field="relative_humidity", low=0.4, high=0.8, bins=3),
    ],
    drifts={"another thermistor": Drift(3435.0, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_hatches(tarl, tarl_drift):
    """Hatch one set of eggs."""
    box = Box(tarl.rng("box"), tarl_drift or 3950.0)
    tarl.start("egg_incubator.py")
    while not box.done:
        box.publish(tarl.bus)
        tarl.step(DT)
        box.advance(*(tarl.bus.latest(topic) for topic in ("heater/duty", "mist/on", "tray/side")))
        tarl.reward(box.judge())
    assert not box.failure, box.failure
