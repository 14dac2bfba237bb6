"""A hot wire cuts blocks of foam. The wire that replaced the old one has a higher resistance."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")

DT = 0.1
OLD_WIRE = 5.1  # ohm per metre
NEW_WIRE = 8.3


class Bench:
    """A cutter with a block; its wire has a resistance of `ohm` per metre."""

    def __init__(self, rng, ohm):
        self.rng = rng
        self.resistance = 0.82 * ohm * rng.normal(1.0, 0.01)
        self.length = float(rng.uniform(130.0, 170.0))
        self.thick = float(rng.uniform(60.0, 110.0))
        self.slope = float(rng.uniform(-0.18, 0.18))  # the block is a wedge
        self.position, self.heat, self.bow, self.wide = 0.0, 0.0, 0.0, 0.0
        self.volts, self.time, self.gained, self.failure = 0.0, 0.0, 0.0, ""

    @property
    def thickness(self):
        """Return the thickness at the wire, in mm."""
        return self.thick + self.slope * self.position

    @property
    def done(self):
        """Return whether the block is cut, or something went wrong."""
        return bool(self.failure) or self.position > self.length + 7.0

    def publish(self, bus):
        """Publish the block, the position and the current."""
        bus.publish("block/thickness", Float32(data=self.thickness + self.rng.normal(0.0, 1.0)))
        bus.publish("block/length", Float32(data=self.length))
        bus.publish("gantry/position", Float32(data=self.position))
        bus.publish("wire/amps", Float32(data=self.volts / self.resistance + self.rng.normal(0.0, 0.02)))

    def advance(self, volts, feed):
        """Cut for one step; a wire that is too cold bows, one that is too hot melts a wide gap."""
        self.volts = volts.data if volts else 0.0
        speed = feed.data if feed else 0.0
        self.heat += 0.08 * (self.volts**2 / self.resistance - self.heat)
        self.position += DT * speed
        self.time += DT
        self.gained = -0.004
        if 0.0 < self.position < self.length and speed > 0.3:
            share = self.heat / (16.0 + 0.115 * speed * self.thickness)
            self.bow = max(0.0, self.bow + DT * speed * (0.82 - share) * 0.9)
            self.wide += DT * (share > 1.3)
            self.gained += 0.05 * DT * speed * max(-1.0, 1.0 - (math.log(share) / 0.22) ** 2)
        if self.bow > 6.0:
            self.failure = "wire bows and tears the foam"
        elif self.wide > 5.0:
            self.failure = "gap is too wide"
        elif self.time > 120.0:
            self.failure = "cut takes too long"
        if self.failure:
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["foam_cutter.py"],
    sensors=[
        Sensor("thickness", topic="block/thickness", field="data", low=30.0, high=140.0, bins=4, unit="mm"),
        Sensor("current", topic="wire/amps", field="data", low=0.0, high=5.0, bins=5, unit="A"),
    ],
    drifts={"new wire": Drift(NEW_WIRE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_cuts(tarl, tarl_drift):
    """Cut one block."""
    bench = Bench(tarl.rng("bench"), tarl_drift or OLD_WIRE)
    tarl.start("foam_cutter.py")
    while not bench.done:
        bench.publish(tarl.bus)
        tarl.step(DT)
        bench.advance(tarl.bus.latest("wire/volts"), tarl.bus.latest("gantry/feed"))
        tarl.reward(bench.gained)
    assert not bench.failure, bench.failure
