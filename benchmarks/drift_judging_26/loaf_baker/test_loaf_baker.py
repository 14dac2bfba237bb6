"""An oven bakes bread. Rye holds more water than wheat and is still gummy when wheat is done.

Nothing earns until the loaf is cut: then a set crumb and a moist loaf do, and a gummy or dry one is a loss.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 15.0  # s
WHEAT = {"sets_at": 91.0}
RYE = {"sets_at": 95.6}  # deg C


class Oven:
    """An oven with a loaf whose crumb sets at some temperature."""

    def __init__(self, rng, sets_at):
        self.rng = rng
        self.sets_at = sets_at + rng.normal(0.0, 0.2)
        self.deck = float(rng.uniform(238.0, 248.0))
        self.core, self.crust = float(rng.uniform(25.0, 29.0)), 40.0
        self.slow = 700.0 * rng.normal(1.0, 0.05)  # s, of a larger or smaller loaf
        self.crumb, self.water, self.steamed = 0.0, 1.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the loaf is out."""
        return self.over

    def publish(self, bus):
        """Publish deck, core and door."""
        bus.publish("oven/deck", Float32(data=self.deck + self.rng.normal(0.0, 0.8)))
        bus.publish("probe/core", Float32(data=self.core + self.rng.normal(0.0, 0.15)))
        bus.publish("oven/loaded", Bool(data=self.time > 3 * DT))

    def cut(self):
        """Cut the loaf."""
        self.over = True
        self.gained = 8.0 - 6.0 * abs(self.water - 0.88) - 0.5 * abs(self.steamed - 10.0) / 10.0
        if self.crumb < 1.0:
            self.failure = "crumb is gummy"
        elif self.water < 0.79:
            self.failure = "loaf is dry"
        if self.failure:
            self.gained = -4.0

    def advance(self, heater, steam, state):
        """Bake for one step."""
        self.time += DT
        self.gained = 0.0
        power = max(0.0, min(1.0, heater.data)) if heater else 0.0
        self.deck += DT * (0.45 * power - (self.deck - 30.0) / 1500.0) + self.rng.normal(0.0, 0.3)
        if self.time > 3 * DT:
            self.crust += DT / 300.0 * (0.7 * self.deck - self.crust)
            self.core += DT / self.slow * (min(self.crust, 99.5) - self.core)
            self.water -= DT * 3.6e-7 * max(0.0, self.crust - 60.0)
            self.steamed += DT / 60.0 if steam and steam.data else 0.0
            self.crumb += (
                DT / 90.0 * math.exp(min(2.0, 2.0 * (self.core - self.sets_at))) * (self.core > 80.0)
            )
        if state == "out" or self.time > 5000.0:
            self.cut()


@pytest.mark.tarl(
    nodes=["loaf_baker.py"],
    sensors=[
        Sensor("core", topic="probe/core", field="data", low=20.0, high=100.0, bins=8, unit="deg C"),
        Sensor("deck", topic="oven/deck", field="data", low=180.0, high=260.0, bins=4, unit="deg C"),
    ],
    drifts={"rye": RYE},
    episodes=200,
    min_success=0.97,
)
def test_bakes(tarl, tarl_drift):
    """Bake one loaf: up to 8 when it is cut, -4 for a gummy or dry one."""
    oven = Oven(tarl.rng("oven"), **(tarl_drift or WHEAT))
    tarl.start("loaf_baker.py")
    bus = tarl.bus
    while not oven.done:
        oven.publish(bus)
        tarl.step(DT)
        state = bus.latest("baker/state")
        oven.advance(bus.latest("oven/heater"), bus.latest("oven/steam"), state.data if state else "")
        tarl.reward(oven.gained)
    assert not oven.failure, oven.failure
