"""A camera mast goes up twice. On some mornings its grease is stiff, and its motor takes more current than usual."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.05
STIFF = 0.1  # share of mornings with stiff grease
HOLD = 60  # number of steps that a picture takes


class Mast:
    """A telescopic mast under trees; `stiff` is the share of the mornings with stiff grease."""

    def __init__(self, rng, stiff):
        self.rng = rng
        self.drag = float(rng.uniform(1.3, 2.1))
        if rng.random() < stiff:
            self.drag = float(rng.uniform(3.9, 5.2))
        self.branch = float(rng.uniform(1.0, 3.4)) if rng.random() < 0.3 else None
        self.height, self.speed, self.current, self.bent = 0.0, 0.0, 0.0, 0.0
        self.photos, self.held, self.now, self.gained, self.failure = 0, 0, 0, 0.0, ""

    @property
    def done(self):
        """Return whether two pictures are taken, or something went wrong."""
        return bool(self.failure) or (self.photos == 2 and self.height < 0.04)

    def publish(self, bus):
        """Publish the height, the current, the wind and the wish."""
        bus.publish("mast/height", Float32(data=self.height + self.rng.normal(0.0, 0.003)))
        bus.publish("mast/current", Float32(data=max(0.0, self.current + self.rng.normal(0.0, 0.12))))
        if self.now % 20 == 0:
            bus.publish("weather/wind", Float32(data=5.0 + self.rng.normal(0.0, 1.0)))
        wanted = self.held < HOLD and self.photos < 2
        bus.publish("mast/wanted", Bool(data=wanted))

    def advance(self, motor, status):
        """Move the mast for one step; a branch bends it until the motor stops, and springs away when it goes back."""
        wish = motor.data if motor else 0.0
        self.now += 1
        before = self.height
        stuck = self.branch is not None and self.height > self.branch and wish > 0.0
        self.speed += 0.4 * (wish - self.speed)
        if stuck:
            self.speed = min(self.speed, 0.01)
            self.bent += DT
        elif wish < 0.0 and self.branch is not None and self.height < self.branch - 0.2:
            self.branch = None
        self.height = max(0.0, self.height + DT * self.speed)
        load = 9.4 if stuck else self.drag * (0.9 + 0.06 * self.height)
        self.current += 0.5 * ((load if wish > 0.0 else 0.7 * (wish < 0.0)) - self.current)
        self.gained = 0.2 * max(0.0, self.height - before) - 0.002
        if self.height > 3.7 and status == "UP":
            self.held += 1
            self.gained += 0.02
        if self.held >= HOLD and self.height < 0.04:
            self.photos, self.held = self.photos + 1, 0
            self.gained += 3.0
        if self.bent > 0.7:
            self.failure = "mast is bent"
        elif status == "ABORT":
            self.failure = "mast has given up"
        elif self.now > 2400:
            self.failure = "pictures take too long"
        if self.failure:
            self.gained -= 12.0


@pytest.mark.tarl(
    nodes=["mast_raiser.py"],
    sensors=[
        Sensor("height", topic="mast/height", field="data", low=0.0, high=4.0, bins=5, unit="m"),
        Sensor("current", topic="mast/current", field="data", low=0.0, high=10.0, bins=5, unit="A"),
    ],
    drifts={"stiff grease": STIFF},
    episodes=300,
    min_success=0.97,
)
def test_raises(tarl, tarl_drift):
    """Take two pictures from the top."""
    mast = Mast(tarl.rng("mast"), tarl_drift or 0.0)
    tarl.start("mast_raiser.py")
    while not mast.done:
        mast.publish(tarl.bus)
        tarl.step(DT)
        told = tarl.bus.latest("mast/status")
        mast.advance(tarl.bus.latest("mast/speed"), told.data if told else "")
        tarl.reward(mast.gained)
    assert not mast.failure, mast.failure
