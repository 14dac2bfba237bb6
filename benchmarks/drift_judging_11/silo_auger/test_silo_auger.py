"""An auger fills a wagon with feed.

In one load in ten a damp lump brakes the auger briefly, and the node stops it as if it were jammed.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.2
LOW, HIGH = 295.0, 312.0  # kg
BURNS = 3.6  # time after which a jammed motor burns (s)
TIME_BOUND = 38.0


class Silo:
    """A silo whose auger meets a stone in one load in five, and damp lumps in the share `damp` of the loads."""

    def __init__(self, rng, damp):
        self.rng = rng
        self.stone = rng.uniform(60.0, 260.0) if rng.uniform() < 0.2 else None
        self.lumps = [rng.uniform(30.0, 120.0), rng.uniform(150.0, 250.0)] if rng.uniform() < damp else []
        self.braked = 0
        self.load, self.speed = 0.0, 0.0
        self.time, self.gained, self.hot = 0.0, 0.0, 0.0
        self.failure = ""
        self.done = False

    @property
    def jammed(self):
        """Return whether a stone blocks the auger."""
        return self.stone is not None and self.load > self.stone

    def publish(self, bus):
        """Publish the torque of the auger and the weight of the wagon."""
        torque = 38.0 * self.speed + self.rng.normal(0.0, 3.0)
        if self.speed > 0.05:
            if self.jammed:
                torque = self.rng.normal(80.0, 4.0)
            elif self.braked:
                torque = self.rng.normal(68.0, 2.5)
        bus.publish("auger/torque", Float32(data=torque))
        bus.publish("wagon/weight", Float32(data=self.load + self.rng.normal(0.0, 1.0)))

    def advance(self, cmd, status):
        """Run the auger for one step."""
        self.speed += 0.7 * ((cmd.data if cmd else 0.0) - self.speed)
        self.time += DT
        before = self.load
        if self.jammed:
            self.hot += DT if self.speed > 0.05 else 0.0
        else:
            share = 0.5 if self.braked else 1.0
            self.load += 12.5 * share * max(0.0, self.speed) * self.rng.normal(1.0, 0.05) * DT
        self.gained = min(self.load, 300.0) - min(before, 300.0)
        self.braked = max(0, self.braked - 1)
        if self.lumps and self.load > self.lumps[0]:
            self.lumps.pop(0)
            self.braked = int(self.rng.integers(5, 8))
        state = status.data if status else "run"
        if state == "jammed":
            self.done = True
            self.failure = "" if self.jammed else "stops without a jam"
            self.gained = 300.0 - before if self.jammed else 0.0
        elif state == "full":
            self.done = True
            self.failure = "" if LOW < self.load < HIGH else "wrong weight"

    def judge(self):
        """Return the reward of the step: feed, and all of it for a jam that is detected."""
        if self.hot > BURNS and not self.done:
            self.failure = "the motor burns"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        if self.failure:
            self.done = True
        return 10.0 * self.gained / 300.0 - 0.002 - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["silo_auger.py"],
    sensors=[
        Sensor("torque", topic="auger/torque", field="data", low=0.0, high=100.0, bins=5, unit="Nm"),
        Sensor("weight", topic="wagon/weight", field="data", low=0.0, high=300.0, bins=3, unit="kg"),
    ],
    drifts={"damp feed": Drift(0.1)},
    episodes=200,
    min_success=0.97,
)
def test_fills(tarl, tarl_drift):
    """Fill one wagon."""
    silo = Silo(tarl.rng("silo"), tarl_drift or 0.0)
    tarl.start("silo_auger.py")
    while not silo.done:
        silo.publish(tarl.bus)
        tarl.step(DT)
        silo.advance(tarl.bus.latest("auger/drive"), tarl.bus.latest("auger/status"))
        tarl.reward(silo.judge())
    assert not silo.failure, silo.failure
