"""A web guide keeps paper on its way through a press. Thin paper at a low tension slips on the swivelling rollers."""

import math
from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
NEWSPRINT = {"tension": 230.0, "grip": 1.0}
TISSUE = {"tension": 75.0, "grip": 0.25}


class Press:
    """A press whose paper has some `tension`, in N, and follows the rollers by a part of `grip`."""

    def __init__(self, rng, tension, grip):
        self.rng = rng
        self.tension = tension * rng.normal(1.0, 0.03)
        self.grip = grip * rng.normal(1.0, 0.05)
        self.wave = float(rng.uniform(13.0, 16.0))  # s, from a reel that was wound unevenly
        self.phase = float(rng.uniform(0.0, 2.0 * math.pi))
        self.wander = 0.0
        self.swivel, self.rate, self.edge = 0.0, 0.0, 0.0
        self.way = deque([0.0] * 4, maxlen=4)  # from the rollers to the sensor
        self.time, self.gained, self.failure, self.heat = 0.0, 0.0, "", 0.0

    @property
    def done(self):
        """Return whether the run is over."""
        return bool(self.failure) or self.time >= 40.0

    def publish(self, bus):
        """Publish the sensors, and every two seconds the tension and that the press runs."""
        if round(self.time / DT) % 20 == 0:
            bus.publish("press/running", Bool(data=True))
            bus.publish("web/tension", Float32(data=self.tension + self.rng.normal(0.0, 3.0)))
        bus.publish("web/edge", Float32(data=self.way[0] + self.rng.normal(0.0, 0.15)))
        bus.publish("guide/swivel", Float32(data=self.swivel))

    def advance(self, rate):
        """Print for one step."""
        self.time += DT
        self.rate += 0.4 * ((rate.data if rate else 0.0) - self.rate)
        self.swivel = max(-70.0, min(70.0, self.swivel + DT * self.rate))
        self.wander += self.rng.normal(0.0, 0.08) - 0.01 * self.wander
        reel = 5.0 * min(1.0, self.time / 4.0) * math.sin(2.0 * math.pi * self.time / self.wave + self.phase)
        self.edge = reel + self.wander + self.grip * self.swivel
        self.way.append(self.edge)
        self.heat += abs(self.rate) * DT - 0.03 * self.heat
        off = abs(self.edge)
        self.gained = 0.025 - 0.006 * max(0.0, off - 2.4)
        if self.time > 5.0 and off > 4.2:
            self.failure = "edge leaves the register"
        elif self.heat > 40.0:
            self.failure = "swivel motor overheats"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["web_guide.py"],
    sensors=[
        Sensor("edge", topic="web/edge", field="data", low=-10.0, high=10.0, bins=8, unit="mm"),
        Sensor("tension", topic="web/tension", field="data", low=0.0, high=300.0, bins=6, unit="N"),
    ],
    drifts={"tissue": TISSUE},
    episodes=200,
    min_success=0.97,
)
def test_guides(tarl, tarl_drift):
    """Print for forty seconds."""
    press = Press(tarl.rng("press"), **(tarl_drift or NEWSPRINT))
    tarl.start("web_guide.py")
    while not press.done:
        press.publish(tarl.bus)
        tarl.step(DT)
        press.advance(tarl.bus.latest("guide/rate"))
        tarl.reward(press.gained)
    assert not press.failure, press.failure
