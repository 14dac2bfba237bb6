"""A line dips candles. In a hot bath, wax of earlier dips melts off before the rack comes out."""

import math
from pathlib import Path

import pytest
import yaml

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Empty = message_type("std_msgs/Empty")
Float32 = message_type("std_msgs/Float32")
Temperature = message_type("sensor_msgs/Temperature")

DT = 0.5
USUAL = 68.0
HOT = 77.0  # degrees


class Bath:
    """A bath of wax of some `temperature`, in degrees Celsius."""

    def __init__(self, rng, temperature):
        self.rng = rng
        self.temperature = temperature + rng.normal(0.0, 0.5)
        self.sticks = 6.4 * rng.normal(1.0, 0.04)  # g per dip
        self.melts = 0.11 * math.exp(0.21 * (self.temperature - 68.0)) * rng.normal(1.0, 0.06)  # g/s
        self.depth, self.wax, self.time_in, self.bubbles = 0.0, 0.0, 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the rack leaves the line."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the hoist, the load cell and, every five seconds, the bath."""
        if round(self.time / DT) % 10 == 0:
            seen = self.temperature + self.rng.normal(0.0, 0.3)
            bus.publish("bath/temperature", Temperature(temperature=seen))
        if round(self.time / DT) == 3:
            bus.publish("line/rack_hung", Empty())
        bus.publish("hoist/position", Float32(data=self.depth))
        wet = 1.5 if self.depth < 0.01 else -4.0 * self.depth
        noise = self.rng.normal(0.0, 0.25)
        bus.publish("rack/load", Float32(data=3.0 + self.wax + noise + min(0.0, wet)))

    def advance(self, speed, state):
        """Move the rack for one step."""
        self.time += DT
        self.gained = -0.002
        self.depth = min(0.32, max(0.0, self.depth + DT * (speed.data if speed else 0.0)))
        if self.depth > 0.02:
            self.time_in += DT
            self.wax = max(0.0, self.wax - DT * self.melts * min(1.0, self.depth / 0.3))
        elif self.time_in > 0.0:
            # cool wax wets slowly; what comes out too early has bubbles
            wets = 0.35 * (1.0 + 2.4 * max(0.0, (76.5 - self.temperature) / 8.5))
            self.bubbles += max(0.0, 0.8 - (1.0 - math.exp(-(self.time_in - 3.8) / wets)))
            self.wax += self.sticks
            self.time_in = 0.0
            if self.bubbles > 2.5:
                self.failure = "candles have bubbles"
        if state and state.data == "done":
            self.over = True
            self.gained += 8.0 - 0.2 * max(0.0, self.wax - 56.0) - 1.0 * self.bubbles
            if not 49.0 < self.wax < 62.0:
                self.failure = "candles have the wrong weight"
        elif state and state.data == "failed":
            self.failure = "candles do not grow"
        elif self.time > 500.0:
            self.failure = "rack takes too long"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["candle_dipper.py"],
    sensors=[
        Sensor("bath", topic="bath/temperature", field="temperature", low=60.0, high=90.0, bins=6, unit="C"),
        Sensor("load", topic="rack/load", field="data", low=0.0, high=65.0, bins=8, unit="g"),
    ],
    drifts={"hot": HOT},
    episodes=200,
    min_success=0.97,
)
def test_dips(tarl, tarl_drift):
    """Dip one rack."""
    bath = Bath(tarl.rng("bath"), tarl_drift or USUAL)
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("candle_dipper.py", parameters=config)
    while not bath.done:
        bath.publish(tarl.bus)
        tarl.step(DT)
        bath.advance(tarl.bus.latest("hoist/speed"), tarl.bus.latest("dipper/state"))
        tarl.reward(bath.gained)
    assert not bath.failure, bath.failure
