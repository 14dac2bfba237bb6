"""A trawler keeps its net in a layer of fish. Against a current of the tide, the net rises above the layer."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 2.0
STEPS = 200
SETTLED = 80  # number of steps until the net fishes
NET = 11.0  # half of the height of the layer and of the net's mouth (m)
BOTTOM = 100.0  # m


class Trawler:
    """A net behind a trawler; `current` in m/s comes from ahead."""

    def __init__(self, rng, current):
        self.rng = rng
        self.water = 1.5 + current + rng.uniform(-0.02, 0.02)
        self.middle = rng.uniform(62.0, 72.0)
        self.wave = rng.uniform(3.0, 6.0), rng.uniform(180.0, 300.0), rng.uniform(0.0, 6.28)
        self.out = 2.5 * self.middle
        self.net = 0.35 * self.out
        self.speed = 0.0
        self.step = 0
        self.caught = 0.0
        self.total = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the haul has ended."""
        return bool(self.failure) or self.step >= STEPS

    def layer(self):
        """Return the depth of the layer of fish."""
        size, period, phase = self.wave
        return self.middle + size * math.sin(2.0 * math.pi * self.step * DT / period + phase)

    def share(self):
        """Return depth per metre of warp: weight of the net against its drag."""
        drag = 1.018 * self.water**2
        return 1.0 / math.sqrt(1.0 + drag**2)

    def publish(self, bus):
        """Publish the echo of the layer, length and tension of the warp, and the log."""
        echo = self.layer() + self.rng.normal(0.0, 1.5) if self.rng.random() > 0.1 else 0.0
        bus.publish("sounder/layer", Float32(data=echo))
        bus.publish("block/length", Float32(data=self.out + self.rng.normal(0.0, 0.3)))
        bus.publish("block/tension", Float32(data=9.0 * self.water**2 + self.rng.normal(0.0, 1.0)))
        bus.publish("log/speed", Float32(data=self.water + self.rng.normal(0.0, 0.02)))

    def advance(self, command):
        """Tow for one step."""
        self.speed = max(-1.5, min(1.5, command.data)) if command else 0.0
        self.out = max(50.0, self.out + self.speed * DT * self.rng.uniform(0.97, 1.03))
        self.net += (self.out * self.share() - self.net) * (1.0 - math.exp(-DT / 15.0))
        self.net += self.rng.normal(0.0, 0.2)
        self.step += 1
        self.caught = 0.0
        if self.step > SETTLED:
            off = (self.net - (self.layer() - 4.0)) / NET
            self.caught = 10.0 / (STEPS - SETTLED) * max(-0.3, 1.0 - 0.6 * off**2)
            self.total += self.caught

    def judge(self):
        """Return the reward of the step: the catch."""
        if self.net > BOTTOM - 8.0:
            self.failure = "the net is torn at the bottom"
        elif self.step >= STEPS and self.total < 6.0:
            self.failure = f"the net is almost empty ({self.total:.1f})"
        return self.caught - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["trawl_winch.py"],
    sensors=[
        Sensor("log", topic="log/speed", field="data", low=1.3, high=2.1, bins=8, unit="m/s"),
        Sensor("layer", topic="sounder/layer", field="data", low=50.0, high=80.0, bins=4, unit="m"),
        Sensor("warp", topic="block/length", field="data", low=120.0, high=300.0, bins=5, unit="m"),
    ],
    drifts={"tide": Drift.range(0.30, 0.44)},
    episodes=200,
    min_success=0.97,
)
def test_fishes(tarl, tarl_drift):
    """Fish for one haul."""
    trawler = Trawler(tarl.rng("trawler"), tarl_drift or 0.0)
    tarl.start("trawl_winch.py")
    while not trawler.done:
        trawler.publish(tarl.bus)
        tarl.step(DT)
        trawler.advance(tarl.bus.latest("winch/speed"))
        tarl.reward(trawler.judge())
    assert not trawler.failure, trawler.failure
