"""Tiles pass a camera. In autumn the low sun sometimes shines on the belt, and glossy tiles look cracked."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")
String = message_type("std_msgs/msg/String")

DT = 0.4
TILES = 45
SCREENED = {"sunny": 0.0}
AUTUMN = {"sunny": 0.22}  # of the hours
MIRRORS = {"matt": 0.15, "satin": 0.25, "gloss": 1.0}
USUAL = {"matt": 0.11, "satin": 0.14, "gloss": 0.19}  # contrast of a sound tile


class Line:
    """An hour at the line; in `sunny` of the hours, the sun shines on some of the tiles."""

    def __init__(self, rng, sunny):
        self.rng = rng
        self.glaze = str(rng.choice(["matt", "satin", "gloss"], p=[0.15, 0.15, 0.7]))
        self.sun = 0.16 * MIRRORS[self.glaze] if rng.random() < sunny else 0.0
        self.shine = int(rng.integers(5, 20))  # first tile of ten in the sun
        self.tile, self.escaped, self.cracked = 0, 0, False
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether the hour is over, or the line stands."""
        return bool(self.failure) or self.tile == TILES

    def publish(self, bus):
        """Publish the next tile, and now and then its glaze."""
        if self.tile % 9 == 0:
            bus.publish("line/glaze", String(data=self.glaze))
        self.cracked = not self.cracked and bool(self.rng.random() < 0.08)
        self.chip = float(self.rng.exponential(0.6))
        usual = USUAL[self.glaze]
        contrast = self.rng.normal(usual + 0.4, 0.035) if self.cracked else self.rng.normal(usual, 0.022)
        if self.shine <= self.tile < self.shine + 10:
            contrast += self.sun
        bus.publish("camera/tile", Float32MultiArray(data=[contrast, self.chip]))

    def advance(self, gate, stop):
        """Put the tile where the gate sends it."""
        self.tile += 1
        grade = gate.data if gate else 0
        self.gained = 0.1
        if self.cracked and grade != 2:
            self.escaped += 1
            self.gained -= 1.5
        elif not self.cracked and grade == 2:
            self.gained -= 0.3
        elif not self.cracked and (self.chip > 1.5) != (grade == 1):
            self.gained -= 0.2
        if stop and stop.data:
            self.failure = "line stands, and nothing is wrong with the kiln"
        elif self.escaped > 2:
            self.failure = "cracked tiles are sold as sound"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["tile_inspector.py"],
    sensors=[
        Sensor("contrast", topic="camera/tile", field="data[0]", low=0.0, high=0.8, bins=8),
        Sensor("chip", topic="camera/tile", field="data[1]", low=0.0, high=4.0, bins=4, unit="mm^2"),
    ],
    drifts={"autumn": AUTUMN},
    episodes=400,
    min_success=0.97,
)
def test_inspects(tarl, tarl_drift):
    """Inspect 45 tiles."""
    line = Line(tarl.rng("line"), **(tarl_drift or SCREENED))
    tarl.start("tile_inspector.py")
    while not line.done:
        line.publish(tarl.bus)
        tarl.step(DT)
        line.advance(tarl.bus.latest("gate"), tarl.bus.latest("line/stop"))
        tarl.reward(line.gained)
    assert not line.failure, line.failure
