"""The feeder delivers its parts in time. A bowl full of brass parts is heavier and resonates at a lower frequency."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float64 = message_type("std_msgs/Float64")
UInt32 = message_type("std_msgs/UInt32")

DT = 0.05
QUALITY = 6.0  # quality factor of the resonance
FASTEST = 20.0  # feed rate at resonance and full amplitude (parts/s)
JAM = 17.0  # feed rate at which the exit jams (parts/s)
TIME_BOUND = 6.5


class Bowl:
    """A bowl on springs with a resonance at `resonance` Hz."""

    def __init__(self, rng, resonance):
        self.rng = rng
        self.weight = 4.0 * (50.0 / resonance) ** 2 + rng.uniform(-0.2, 0.2)
        self.resonance = resonance * rng.uniform(0.985, 1.015)
        self.order = int(rng.integers(32, 41))
        self.way, self.exit, self.new = 0.0, 0, 0
        self.shaking = 0.0
        self.time = 0.0
        self.full = False
        self.failure = ""

    def response(self, frequency):
        """Return the amplitude at a frequency as a share of that at resonance."""
        ratio = max(1.0, frequency) / self.resonance
        return 1.0 / QUALITY / math.hypot(1.0 - ratio * ratio, ratio / QUALITY)

    def publish(self, bus):
        """Publish order, scale and counter."""
        bus.publish("scale", Float64(data=self.weight + self.rng.normal(0.0, 0.05)))
        bus.publish("order", UInt32(data=self.order))
        bus.publish("exit/count", UInt32(data=self.exit))

    def advance(self, frequency, amplitude, full):
        """Shake for one step."""
        drive = max(0.0, min(1.0, amplitude.data)) if amplitude else 0.0
        wanted = drive * self.response(frequency.data) if frequency else 0.0
        self.shaking += (wanted - self.shaking) * 0.3
        self.way += max(0.0, FASTEST * self.shaking * (1.0 + self.rng.normal(0.0, 0.2))) * DT
        self.new = int(self.way) - self.exit
        self.exit += self.new
        self.full = bool(full and full.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step, for each needed part."""
        needed = self.new if self.exit <= self.order else 0
        if FASTEST * self.shaking > JAM:
            self.failure = "parts jam at the exit"
        elif self.time > TIME_BOUND:
            self.failure = "the machine waits for parts"
        return 10.0 * needed / self.order - (6.0 if self.failure else 0.005)


@pytest.mark.tarl(
    nodes=["feeder.py"],
    sensors=[
        Sensor("scale", topic="scale", field="data", low=3, high=9, bins=6, unit="kg"),
        Sensor("counted", topic="exit/count", field="data", low=0, high=40, bins=4),
    ],
    drifts={"brass": 37.0},
    episodes=100,
    min_success=0.95,
)
def test_feeds_in_time(tarl, tarl_drift):
    """Deliver one order."""
    bowl = Bowl(tarl.rng("bowl"), tarl_drift or 50.0)
    tarl.start("feeder.py")
    while not (bowl.full or bowl.failure):
        bowl.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        bowl.advance(latest("magnets/frequency"), latest("magnets/amplitude"), latest("full"))
        tarl.reward(bowl.judge())
    assert not bowl.failure, bowl.failure
