"""The mast holds its camera near the requested height for any charge of the battery."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.1
TIME = 14.0
SETTLED = 7.0  # time from which the height is rewarded, s
BAND = 0.3  # m
MOST_OUT = 2.5  # s
WEIGHT = 2.25  # m/s²
STRENGTH = 5.0  # acceleration at full duty and full battery (m/s²)


class Yard:
    """A mast; `charge` is the battery's voltage as a share of the nominal one."""

    def __init__(self, rng, charge):
        self.rng = rng
        self.charge = charge * rng.uniform(0.98, 1.02)
        self.goal = rng.uniform(1.0, 3.0)
        self.height, self.speed = rng.uniform(0.0, 0.5), 0.0
        self.out = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the mission is over."""
        return self.time >= TIME

    def publish(self, bus):
        """Publish the measurements of encoder and voltmeter."""
        bus.publish("/volts", Float32(data=24.0 * self.charge + self.rng.normal(0.0, 0.1)))
        bus.publish("/goal", Float32(data=self.goal))
        bus.publish("/height", Float32(data=self.height + self.rng.normal(0.0, 0.003)))

    def advance(self, winch):
        """Wind for one step; there is a lower stop."""
        duty = max(0.0, min(1.0, winch.data)) if winch else 0.0
        self.speed += (STRENGTH * self.charge * duty - WEIGHT - 1.2 * self.speed) * DT
        self.height += self.speed * DT
        if self.height < 0.0:
            self.height, self.speed = 0.0, 0.0
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time < SETTLED:
            return 0.0
        if abs(self.height - self.goal) <= BAND:
            return 10.0 * DT / (TIME - SETTLED)
        self.out += DT
        if self.out > MOST_OUT:
            self.failure = "the camera is not where it should be"
            return -4.0
        return 0.0


@pytest.mark.tarl(
    nodes=["mast.py"],
    sensors=[
        Sensor("volts", topic="/volts", field="data", low=12, high=26, bins=7, unit="V"),
        Sensor("height", topic="/height", field="data", low=0, high=3, bins=6, unit="m"),
    ],
    drifts={"tired battery": Drift.range(0.64, 0.76)},
    episodes=100,
    min_success=0.95,
)
def test_holds_the_camera(tarl, tarl_drift):
    """Keep the camera up."""
    yard = Yard(tarl.rng("yard"), tarl_drift or 1.0)
    tarl.start("mast.py")
    while not (yard.done or yard.failure):
        yard.publish(tarl.bus)
        tarl.step(DT)
        yard.advance(tarl.bus.latest("/winch"))
        tarl.reward(yard.judge())
    assert not yard.failure, yard.failure
