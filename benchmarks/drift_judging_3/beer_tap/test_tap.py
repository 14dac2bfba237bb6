"""A glass is full and has no more foam than its head. Beer from a warm keg foams if it flows fast."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
UInt16 = message_type("std_msgs/UInt16")

DT = 0.1
FLOW = 80.0  # flow through an open valve (ml/s)
MOST_FOAM = 35.0  # ml
DRIP = 0.05  # time for which the spout still drips (s)


class Bar:
    """A tap; beer does not foam up to a flow of `calm` ml/s."""

    def __init__(self, rng, calm):
        self.rng = rng
        self.keg = rng.uniform(3.0, 6.0) if calm > FLOW else rng.uniform(10.0, 14.0)
        self.calm = calm * rng.uniform(0.95, 1.05)
        self.order = int(rng.choice([300, 400, 500]))
        self.poured, self.flow, self.foam, self.gained = 0.0, 0.0, 0.0, 0.0
        self.time = 0.0
        self.served = False
        self.failure = ""

    def publish(self, bus):
        """Publish order, scale and the thermometer of the line."""
        if self.time == 0.0:
            bus.publish("bar/order", UInt16(data=self.order))
        bus.publish("bar/line_temperature", Float32(data=self.keg + self.rng.normal(0.0, 0.1)))
        bus.publish("bar/scale", Float32(data=(self.poured + self.rng.normal(0.0, 0.5)) / 0.99))

    def advance(self, valve, tilt, served):
        """Pour for one step."""
        opening = max(0.0, min(1.0, valve.data)) if valve else 0.0
        self.flow += (FLOW * opening - self.flow) * DT / (DRIP + DT)
        self.gained = self.flow * DT
        self.poured += self.gained
        self.foam += 0.5 * max(0.0, self.flow - self.calm) * DT
        if self.gained > 0.5 and self.poured < 0.4 * self.order and (tilt is None or tilt.data < 30.0):
            self.foam += 2.0  # beer falls to the bottom of a straight glass
        self.served = bool(served and served.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step: beer is rewarded, foam costs."""
        if self.foam > MOST_FOAM:
            self.failure = "foam runs over"
        elif self.time > 5.0 + self.order / 25.0:
            self.failure = "the guest has left"
        elif self.served and abs(self.poured - self.order) > 12.0:
            self.failure = f"{self.poured:.0f} ml in a glass of {self.order}"
        if self.failure:
            return -5.0
        return 10.0 * self.gained / self.order - 0.005 - (0.05 * self.foam if self.served else 0.0)


@pytest.mark.tarl(
    nodes=["tap.py"],
    sensors=[
        Sensor("line", topic="bar/line_temperature", field="data", low=2, high=14, bins=4, unit="°C"),
        Sensor("scale", topic="bar/scale", field="data", low=0, high=500, bins=5, unit="g"),
    ],
    drifts={"warm keg": 42.0},
    episodes=100,
    min_success=0.95,
)
def test_pours(tarl, tarl_drift):
    """Pour one glass."""
    bar = Bar(tarl.rng("bar"), tarl_drift or 120.0)
    tarl.start("tap.py")
    while not (bar.served or bar.failure):
        bar.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        bar.advance(latest("tap/valve"), latest("tap/tilt"), latest("bar/served"))
        tarl.reward(bar.judge())
    assert not bar.failure, bar.failure
