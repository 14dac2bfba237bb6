"""An air-jet loom inserts its weft. A heavier yarn starts more slowly, and needs more force to be stopped."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 0.2  # s from pick to pick
REED = 1.9  # m
SHED = 42.0  # ms
FINE, COARSE = 20.0, 31.0  # tex


class Loom:
    """A loom with a weft of some `tex`, in g per km."""

    def __init__(self, rng, tex):
        self.rng = rng
        self.tex = tex
        self.mass = tex / 20.0 * rng.normal(1.0, 0.012)
        self.nozzle = 860.0 * rng.normal(1.0, 0.012)  # m/s2 per bar for a yarn of 20 tex
        self.drag = 0.20 * rng.normal(1.0, 0.02)  # 1/m
        self.picks, self.arrived, self.insertions, self.stopped = 0, None, [], False
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the cloth is woven."""
        return bool(self.failure) or self.picks >= 60

    def publish(self, bus):
        """Publish the last arrival, the next pick and, every two seconds, the yarn."""
        if self.picks % 10 == 0:
            bus.publish("creel/yarn", Float32(data=self.tex))
        if self.arrived is not None:
            bus.publish("weft/arrival", Float32(data=self.arrived))
            self.arrived = None
        self.picks += 1
        bus.publish("loom/pick", Int32(data=self.picks))

    def insert(self, pressure, blow):
        """Blow one weft; return when it arrives in ms, and how fast."""
        force = self.nozzle * pressure / self.mass * self.rng.normal(1.0, 0.008)
        speed, way = 0.0, 0.0
        for tick in range(120):
            push = force * max(0.0, min(1.0, 2.0 * (blow - 0.5 * tick)))
            speed += 0.0005 * (push - self.drag * speed * speed)
            way += 0.0005 * speed
            if way >= REED:
                return 0.5 * tick, speed
        return 60.0, speed

    def advance(self, stop):
        """Weave one pick."""
        self.time += DT
        self.gained = 0.0
        for pressure, blow in self.insertions[-1:]:
            at, speed = self.insert(pressure, blow)
            energy = self.mass * (speed / 40.0) ** 2  # of the yarn that is stopped
            if at > SHED:
                self.arrived = -1.0
                self.gained -= 0.3
            else:
                self.arrived = at + self.rng.normal(0.0, 0.3)
                self.gained += 0.12 - 0.1 * max(0.0, energy - 2.2)
            if energy > 2.6:
                self.failure = "weft breaks at the stop pin"
        self.insertions.clear()
        if stop:
            self.failure = "loom stops"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["weft_inserter.py"],
    sensors=[
        Sensor("yarn", topic="creel/yarn", field="data", low=10.0, high=50.0, bins=8, unit="tex"),
        Sensor("arrival", topic="weft/arrival", field="data", low=30.0, high=46.0, bins=8, unit="ms"),
    ],
    drifts={"coarse": COARSE},
    episodes=200,
    min_success=0.97,
)
def test_weaves(tarl, tarl_drift):
    """Weave sixty picks."""
    loom = Loom(tarl.rng("loom"), tarl_drift or FINE)
    tarl.start("weft_inserter.py")
    tarl.bus.subscribe("jet/insertion", lambda message: loom.insertions.append((message.x, message.y)))
    while not loom.done:
        loom.publish(tarl.bus)
        tarl.step(DT)
        loom.advance(tarl.bus.latest("loom/stop"))
        tarl.reward(loom.gained)
    assert not loom.failure, loom.failure
