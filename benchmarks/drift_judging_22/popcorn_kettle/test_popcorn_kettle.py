"""A kiosk makes popcorn. A bag is mixed from two harvests, and the moister kernels pop after a pause."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.25
ONE = {"moist": 0.0}
MIXED = {"moist": 0.7}  # share of the kernels that pop later


class Kettle:
    """Kernels, of which the share `moist` pops later."""

    def __init__(self, rng, moist):
        self.rng = rng
        late = int(70 * moist * rng.uniform(0.9, 1.1))
        first = rng.normal(4.5, 0.7 if moist else 1.1, 70 - late)
        second = rng.normal(10.3, 0.7, late)
        self.heats = sorted([*first.clip(1.5, 7.5), *second.clip(8.9, 12.5)])  # heat at which a kernel pops
        self.heat, self.popped, self.new, self.quiet, self.tipped = 0.0, 0, 0, 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the kettle is empty."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the filling once, and the pops of the last step."""
        if round(self.time / DT) == 2:
            bus.publish("kettle/filled", Bool(data=True))
        bus.publish("mic/pops", UInt8(data=min(255, self.new)))

    def advance(self, heater, tilt):
        """Heat for one step; a guest pays for a full and unburnt bag."""
        self.time += DT
        self.gained = 0.0
        self.heat += DT * (heater.data if heater else 0.0)
        before = self.popped
        while self.popped < len(self.heats) and self.heats[self.popped] < self.heat:
            self.popped += 1
        self.new = self.popped - before
        full = self.popped / len(self.heats)
        self.quiet = 0.0 if self.new or full < 0.97 else self.quiet + DT
        self.tipped = self.tipped + DT if tilt and tilt.data > 1.0 else 0.0
        if self.quiet > 8.5:
            self.failure = "popcorn burns"
        elif self.time > 35.0:
            self.failure = "guest leaves"
        elif self.tipped > 0.9:
            self.over = True
            if full < 0.85:
                self.failure = "bag is full of kernels"
            else:
                self.gained = 10.0 * min(1.0, full / 0.98)


@pytest.mark.tarl(
    nodes=["popcorn_kettle.py"],
    sensors=[
        Sensor("pops", topic="mic/pops", field="data", low=0.0, high=12.0, bins=6),
    ],
    drifts={"mixed": MIXED},
    episodes=200,
    min_success=0.97,
)
def test_pops(tarl, tarl_drift):
    """Make one bag."""
    kettle = Kettle(tarl.rng("kettle"), **(tarl_drift or ONE))
    tarl.start("popcorn_kettle.py")
    while not kettle.done:
        kettle.publish(tarl.bus)
        tarl.step(DT)
        kettle.advance(tarl.bus.latest("kettle/heater"), tarl.bus.latest("kettle/tilt"))
        tarl.reward(kettle.gained)
    assert not kettle.failure, kettle.failure
