"""A baker sheets dough for croissants. Dough of spelt has less gluten, and tears if it is rolled out too fast.

The dough earns for the right final thickness, and costs a little with each second; a tear ends the batch.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.1
WHEAT = {"strength": 0.52}
SPELT = {"strength": 0.36}  # part of the thickness that a pass may take


class Bakery:
    """A block of dough of some `strength`."""

    def __init__(self, rng, strength):
        self.rng = rng
        self.strength = strength * rng.normal(1.0, 0.012)
        self.spring = float(rng.uniform(1.06, 1.14))
        self.thickness = float(rng.uniform(28.0, 36.0))
        self.area = float(rng.uniform(0.011, 0.014))  # m2, of the side: length times thickness
        self.gap = 40.0
        self.way, self.rolling = 0.0, False
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the dough is sheeted."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the rollers, the guard, and the thickness of a dough that lies still."""
        bus.publish("rollers/gap", Float32(data=self.gap + self.rng.normal(0.0, 0.015)))
        step = round(self.time / DT)
        if step % 20 == 0:
            bus.publish("guard/open", Bool(data=False))
        if step == 5 or (self.rolling and self.way >= self.length()):
            self.rolling = False
            bus.publish("dough/thickness", Float32(data=self.thickness * self.rng.normal(1.0, 0.006)))

    def length(self):
        """Return the way of the belt in m until the dough has passed."""
        return 0.3 + self.area / (0.001 * self.thickness)

    def advance(self, setpoint, belt, state):
        """Roll for one step."""
        self.time += DT
        self.gained = -0.001
        wanted = setpoint.data if setpoint else 40.0
        self.gap += max(-1.2, min(1.2, wanted - self.gap))
        speed = abs(belt.data) if belt else 0.0
        if speed > 0.05 and not self.rolling:
            self.rolling, self.way = True, 0.0
            taken = 1.0 - self.gap / self.thickness
            if taken > self.strength:
                self.failure = "dough tears"
            self.thickness = min(self.thickness, self.gap * self.spring * self.rng.normal(1.0, 0.008))
        if self.rolling:
            self.way += DT * speed
        if state and state.data == "finished":
            self.over = True
            off = abs(self.thickness - 4.0)
            self.gained += 8.0 - 2.0 * max(0.0, off - 0.3)
            if off > 0.8:
                self.failure = "sheet has the wrong thickness"
        elif self.time > 75.0:
            self.failure = "butter melts"
        elif state and state.data == "alarm":
            self.failure = "sheeter stops"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["dough_sheeter.py"],
    sensors=[
        Sensor("thickness", topic="dough/thickness", field="data", low=0.0, high=40.0, bins=10, unit="mm"),
        Sensor("gap", topic="rollers/gap", field="data", low=0.0, high=40.0, bins=8, unit="mm"),
    ],
    drifts={"spelt": SPELT},
    episodes=200,
    min_success=0.97,
)
def test_sheets(tarl, tarl_drift):
    """Sheet one block: 8 for the right thickness, a small cost per second, -4 for a tear or a failure."""
    bakery = Bakery(tarl.rng("bakery"), **(tarl_drift or WHEAT))
    tarl.start("dough_sheeter.py")
    bus = tarl.bus
    while not bakery.done:
        bakery.publish(bus)
        tarl.step(DT)
        bakery.advance(
            bus.latest("rollers/gap_setpoint"), bus.latest("belt/speed"), bus.latest("sheeter/state")
        )
        tarl.reward(bakery.gained)
    assert not bakery.failure, bakery.failure
