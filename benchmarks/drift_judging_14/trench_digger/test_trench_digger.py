"""An excavator digs a trench to the plane of a laser. On a winter morning its oil is cold."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
OFF_GRADE = 0.075  # m
FAR, NEAR = 7.0, 3.0  # reach of the stick (m)
TIME_BOUND = 40.0
WINTER = -6.0  # degrees C


class Excavator:
    """An excavator with oil of some temperature, whose valves open late and little when it is cold."""

    def __init__(self, rng, oil):
        self.rng = rng
        self.oil = oil
        self.height = rng.uniform(0.10, 0.16)
        self.reach = FAR
        self.phase = rng.uniform(-0.3, 0.3)
        self.ground = 0.0
        self.boom = 0.0
        self.off, self.pulled = 0.0, False
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the pass is done, or was broken off."""
        return bool(self.failure) or self.reach <= NEAR

    def valve(self, spool, wide):
        """Return the share of the full flow; cold oil needs a wider gap."""
        cold = 1.0 / (1.0 + math.exp((self.oil - 14.0) / 5.0))
        closed = 0.10 + 0.18 * cold if wide is None else wide
        flow = max(0.0, abs(spool) - closed) * (1.0 - 0.2 * cold)
        return math.copysign(flow, spool)

    def publish(self, bus):
        """Publish the height of the edge above the plane, the reach and the oil."""
        bus.publish("laser/height", Float32(data=self.height + self.rng.normal(0.0, 0.003)))
        bus.publish("stick/reach", Float32(data=self.reach + self.rng.normal(0.0, 0.01)))
        bus.publish("hydraulics/oil_temp", Float32(data=self.oil + self.rng.normal(0.0, 0.5)))

    def advance(self, boom, stick):
        """Move boom and stick for one step; the stick swings the edge on an arc, and the ground lifts it."""
        share = 1.0 - math.exp(-DT / 0.12)
        self.boom += (0.5 * self.valve(boom.data if boom else 0.0, None) - self.boom) * share
        pull = 1.1 * self.valve(stick.data if stick else 0.0, 0.10)
        before = self.reach
        self.reach -= pull * DT
        self.ground = 0.9 * self.ground + self.rng.normal(0.0, 0.004)
        arc = 0.15 * math.sin(math.pi * (FAR - self.reach) / 2.0 + self.phase)
        self.height += (self.boom + pull * (arc + self.ground)) * DT
        self.oil += 0.02 * DT
        self.pulled = self.pulled or pull > 0.0
        off = abs(self.height)
        self.off = self.off + DT if self.pulled and off > OFF_GRADE else 0.0
        self.time += DT
        share = (before - self.reach) / (FAR - NEAR)
        self.gained = 10.0 * share * (1.0 - min(1.0, (off / OFF_GRADE) ** 2)) - 0.003

    def judge(self):
        """Return the reward of the step: ground that is cut to grade."""
        if self.off > 0.5:
            self.failure = f"the floor is {100 * self.height:.0f} cm off grade"
        elif self.time > TIME_BOUND:
            self.failure = "the pass takes too long"
        return self.gained - (3.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["trench_digger.py"],
    sensors=[
        Sensor("height", topic="laser/height", field="data", low=-0.12, high=0.12, bins=6, unit="m"),
        Sensor("reach", topic="stick/reach", field="data", low=3.0, high=7.0, bins=4, unit="m"),
        Sensor("oil", topic="hydraulics/oil_temp", field="data", low=-20.0, high=80.0, bins=5, unit="°C"),
    ],
    drifts={"winter morning": Drift(WINTER)},
    episodes=200,
    min_success=0.97,
)
def test_digs(tarl, tarl_drift):
    """Dig one pass."""
    rng = tarl.rng("excavator")
    warm = rng.uniform(40.0, 65.0)
    excavator = Excavator(rng, warm if tarl_drift is None else tarl_drift)
    tarl.start("trench_digger.py")
    while not excavator.done:
        excavator.publish(tarl.bus)
        tarl.step(DT)
        excavator.advance(tarl.bus.latest("valves/boom"), tarl.bus.latest("valves/stick"))
        tarl.reward(excavator.judge())
    assert not excavator.failure, excavator.failure
