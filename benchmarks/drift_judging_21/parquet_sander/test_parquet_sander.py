"""A robot sands floors of hardwood. In old houses, parts of the floor are pine, whose resin clogs the paper."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Range = message_type("sensor_msgs/msg/Range")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.2
OAK, BEECH, PINE = 1, 2, 3
HARDWOOD = {"patch": BEECH, "resin": 0.0}
OLD_HOUSE = {"patch": PINE, "resin": Drift.range(0.6, 1.2)}
NEEDS = {OAK: 60.0, BEECH: 56.0, PINE: 30.0}  # N that take the lacquer off, and no more


class Floor:
    """A floor of oak with a patch of another wood, which has `resin`."""

    def __init__(self, rng, patch, resin):
        self.rng = rng
        self.patch = patch
        self.resin = resin
        self.length = float(rng.uniform(3.6, 4.6))
        start = rng.uniform(0.5, 1.6)
        self.where = (start, start + rng.uniform(1.2, 1.8))
        self.paper = 1.0 + rng.normal(0.0, 0.02)
        self.at, self.clog, self.rough, self.steps = 0.0, 0.0, 0, 0
        self.gained, self.failure, self.over = 0.0, "", False

    @property
    def done(self):
        """Return whether the strip is sanded, or spoilt."""
        return bool(self.failure) or self.over

    @property
    def wood(self):
        """Return the wood below the drum."""
        return self.patch if self.where[0] <= self.at < self.where[1] else OAK

    def publish(self, bus):
        """Publish the distance to the wall and the wood."""
        bus.publish("front/range", Range(range=max(0.0, self.length - self.at + self.rng.normal(0.0, 0.005))))
        bus.publish("floor/species", UInt8(data=self.wood))

    def advance(self, twist, force, mode):
        """Sand for one step."""
        self.steps += 1
        self.gained = -0.005
        push = force.data if force else 0.0
        speed = twist.linear.x if twist else 0.0
        self.at += DT * speed * self.rng.normal(1.0, 0.02)
        if speed > 0.0 and self.at > 0.15:
            self.sand(push)
        if mode and mode.data == "lift":
            self.over = True
            self.gained += 2.0
        if self.clog > 1.0:
            self.failure = "paper is clogged, and scorches the floor"
        elif self.rough > 9:
            self.failure = "lacquer is left on the floor"
        elif self.at > self.length - 0.1:
            self.failure = "drum runs into the wall"
        elif self.steps > 200:
            self.failure = "strip takes too long"
        if self.failure:
            self.gained -= 5.0

    def sand(self, push):
        """Take wood off; resin melts above some pressure."""
        need = NEEDS[self.wood]
        cut = push * self.paper * (1.0 - 0.3 * self.clog) / need + self.rng.normal(0.0, 0.02)
        if self.wood == PINE:
            self.clog += 0.075 * self.resin * max(0.0, push / 32.0 - 1.0)
        if cut < 0.8:
            self.rough += 1
            self.gained -= 0.1
        self.gained += 0.05 - 0.08 * max(0.0, abs(cut - 1.0) - 0.1)


@pytest.mark.tarl(
    nodes=["parquet_sander.py"],
    sensors=[
        Sensor("species", topic="floor/species", field="data", low=0.0, high=6.0, bins=6),
        Sensor("ahead", topic="front/range", field="range", low=0.0, high=5.0, bins=5, unit="m"),
    ],
    drifts={"old_house": OLD_HOUSE},
    episodes=200,
    min_success=0.97,
)
def test_sands(tarl, tarl_drift):
    """Sand one strip."""
    floor = Floor(tarl.rng("floor"), **(tarl_drift or HARDWOOD))
    tarl.start("parquet_sander.py")
    while not floor.done:
        floor.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        floor.advance(bus.latest("cmd_vel"), bus.latest("drum/force"), bus.latest("sander/mode"))
        tarl.reward(floor.gained)
    assert not floor.failure, floor.failure
