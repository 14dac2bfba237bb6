"""A station inflates tyres by time. Tyres of vans hold 1.8 times the air, and need the valve 1.8 times as long."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.05
TYRES = 4
FLOW = 10.0 / 5.2  # a tyre of volume 1 has ten units of air per bar
RIGHT = 0.14  # share of the missing pressure
GAP = 10  # steps
TIME_BOUND = 120.0


class Station:
    """A car, and a hose whose flow fills a tyre of a given volume."""

    def __init__(self, rng, volume):
        self.rng = rng
        self.volume = volume
        self.volumes = 10.0 * volume * rng.uniform(0.97, 1.03, TYRES)
        self.target = rng.uniform(2.2, 2.7)
        self.before = rng.uniform(1.2, 1.9, TYRES)
        self.pressure = self.before[0]
        self.tyre, self.gap, self.coupled = 0, GAP, False
        self.finished, self.off = False, 0.0
        self.flowing = False
        self.wrong = 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all tyres are released, or the episode has failed."""
        return self.tyre == TYRES or bool(self.failure)

    def publish(self, bus):
        """Publish the target of the tyre that waits, the gauge, and the wheel size that the camera reads."""
        gauge = self.pressure + (1.5 if self.flowing else 0.0) + self.rng.normal(0.0, 0.01)
        bus.publish("camera/wheel_size", Float32(data=15.0 if self.volume < 1.4 else 17.5))
        bus.publish("car/target", Float32(data=0.0 if self.gap else self.target))
        bus.publish("hose/pressure", Float32(data=gauge if self.coupled else 0.0))

    def advance(self, couple, valve):
        """Couple, fill or release for one step."""
        self.time += DT
        self.finished = False
        if self.gap:
            self.gap -= 1
            return
        was, self.coupled = self.coupled, bool(couple and couple.data)
        self.flowing = self.coupled and bool(valve and valve.data)
        if self.flowing:
            self.pressure += FLOW / self.volumes[self.tyre] * DT
        if was and not self.coupled:
            missing = self.target - self.before[self.tyre]
            self.off = abs(self.target - self.pressure) / missing
            self.wrong += self.off > RIGHT
            self.finished = True
            self.tyre, self.gap = self.tyre + 1, GAP
            if self.tyre < TYRES:
                self.pressure = self.before[self.tyre]

    def judge(self):
        """Return the reward of the step: each tyre is rewarded by its pressure, and time costs."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        elif self.tyre == TYRES and self.wrong:
            self.failure = f"{self.wrong} tyres have a wrong pressure"
        reward = -0.0002
        if self.finished:
            reward += 2.5 - 3.0 * self.off if self.off <= RIGHT else -1.0
        return reward - 1.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["tyre_inflator.py"],
    sensors=[
        Sensor("wheel", topic="camera/wheel_size", field="data", low=14, high=18, bins=4, unit="inch"),
        Sensor("pressure", topic="hose/pressure", field="data", low=0.5, high=4.0, bins=5, unit="bar"),
    ],
    drifts={"vans": Drift(1.8)},
    episodes=100,
    min_success=0.95,
)
def test_inflates(tarl, tarl_drift):
    """Inflate the four tyres of one car."""
    station = Station(tarl.rng("station"), tarl_drift or 1.0)
    tarl.start("tyre_inflator.py")
    while not station.done:
        station.publish(tarl.bus)
        tarl.step(DT)
        station.advance(tarl.bus.latest("hose/couple"), tarl.bus.latest("hose/valve"))
        tarl.reward(station.judge())
    assert not station.failure, station.failure
