"""A grader cuts a plane. On windy days its mast sways, and the valve of the blade works without a pause."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
CALM = {"sway": 0.0, "wind": 2.0}
WINDY = {"sway": 0.028, "wind": 11.0}  # m; m/s


class Site:
    """A grader whose mast sways by `sway`, in m."""

    def __init__(self, rng, sway, wind):
        self.rng = rng
        self.sway, self.wind = sway * rng.uniform(0.85, 1.15), wind
        self.rhythm = 2.0 * math.pi * rng.uniform(1.2, 1.6)
        self.tilt = 0.016 * rng.choice([-1.0, 1.0])  # m/s by which the ground lifts the blade
        self.blade = float(rng.uniform(-0.04, 0.04))
        self.side, self.turns, self.deep = 0, 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the pass is over."""
        return bool(self.failure) or self.time > 10.0

    def publish(self, bus):
        """Publish the receiver, and every second the wind at the weather station."""
        if round(self.time / DT) % 10 == 0:
            bus.publish("cab/auto", Bool(data=True))
            bus.publish("site/wind", Float32(data=abs(self.wind + self.rng.normal(0.0, 0.8))))
        seen = self.blade + self.sway * math.sin(self.rhythm * self.time) + self.rng.normal(0.0, 0.0015)
        bus.publish("mast/offset", Float32(data=seen))

    def advance(self, valve):
        """Drive for one step."""
        self.time += DT
        self.gained = 0.0
        push = valve.data if valve else 0.0
        if round(self.time / DT) % 30 == 0:
            self.tilt = -self.tilt
        moved = push - math.copysign(0.08, push) if abs(push) > 0.08 else 0.0
        side = (moved > 0.0) - (moved < 0.0)
        if side and side != self.side:
            self.turns += 1
            self.side = side
        self.blade += DT * (0.1 * moved + self.tilt)
        off = abs(self.blade)
        self.deep = self.deep + 1 if off > 0.045 else 0
        if self.time > 1.5:
            self.gained = 0.1 - 4.0 * max(0.0, off - 0.025)
        if self.turns > 12:
            self.failure = "valve overheats"
        elif self.deep > 12:
            self.failure = "ground is cut in waves"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["laser_grader.py"],
    sensors=[
        Sensor("wind", topic="site/wind", field="data", low=0.0, high=16.0, bins=8, unit="m/s"),
        Sensor("offset", topic="mast/offset", field="data", low=-0.1, high=0.1, bins=8, unit="m"),
    ],
    drifts={"windy": WINDY},
    episodes=200,
    min_success=0.97,
)
def test_grades(tarl, tarl_drift):
    """Cut one pass."""
    site = Site(tarl.rng("site"), **(tarl_drift or CALM))
    tarl.start("laser_grader.py")
    while not site.done:
        site.publish(tarl.bus)
        tarl.step(DT)
        site.advance(tarl.bus.latest("blade/valve"))
        tarl.reward(site.gained)
    assert not site.failure, site.failure
