"""A robot runs totes along an aisle. With more robots in the hall, its sonar hears the pings of the others."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Odometry = message_type("nav_msgs/Odometry")
Range = message_type("sensor_msgs/Range")

DT = 0.1
AISLE = 20.0  # m
SEES = 3.0  # m
TIME_BOUND = 38.0
BUSY = 0.06  # share of the readings that are pings of other robots


class Aisle:
    """An aisle with people who step into it, and a robot whose sonar hears others with a probability."""

    def __init__(self, rng, crosstalk):
        self.rng = rng
        self.crosstalk = crosstalk
        self.people = sorted(rng.uniform(3.0, AISLE - 3.0) for _ in range(2))
        self.notice = [rng.uniform(1.7, 2.6) for _ in self.people]
        self.stays = [rng.uniform(1.5, 3.0) for _ in self.people]
        self.grip = rng.uniform(1.4, 1.8)
        self.x, self.v = 0.0, 0.0
        self.brake = 1.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the tote is there, or the run has failed."""
        return bool(self.failure) or self.x >= AISLE - 0.25

    def gap(self):
        """Return the distance to the next person in the aisle, in m."""
        if self.people and self.people[0] - self.x < self.notice[0]:
            return self.people[0] - self.x
        return SEES

    def publish(self, bus):
        """Publish odometry, sonar and the end of the aisle."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x + self.rng.normal(0.0, 0.01)
        odom.twist.twist.linear.x = self.v
        bus.publish("odom", odom)
        seen = Range(min_range=0.2, max_range=SEES)
        seen.range = min(SEES, self.gap() + self.rng.normal(0.0, 0.02))
        if self.rng.random() < self.crosstalk:
            seen.range = self.rng.uniform(0.25, 0.7)
        bus.publish("sonar", seen)
        bus.publish("runner/goal", Float32(data=AISLE))

    def advance(self, command, brake):
        """Drive for one step. The parking brake takes 1.5 s to open, and the wheels brake at once."""
        closed = brake is None or brake.data
        self.brake = 1.5 if closed else max(0.0, self.brake - DT)
        wanted = command.linear.x if command and self.brake == 0.0 else 0.0
        if wanted < self.v:
            self.v = max(wanted, self.v - self.grip * DT)
        else:
            self.v += (wanted - self.v) * (1.0 - math.exp(-DT / 0.2))
        before = self.x
        self.x += self.v * DT
        self.time += DT
        self.gained = 0.65 * (self.x - before) - 0.01
        self._meet()

    def _meet(self):
        if self.gap() >= SEES:
            return
        if self.gap() < 0.05:
            self.failure = "the robot runs into a person"
        elif self.v < 0.05:
            self.stays[0] -= DT
            if self.stays[0] < 0.0:
                for row in (self.people, self.notice, self.stays):
                    row.pop(0)

    def judge(self):
        """Return the reward of the step: way along the aisle."""
        if self.time > TIME_BOUND:
            self.failure = "the tote is late"
        return self.gained - (6.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["tote_runner.py"],
    sensors=[
        Sensor("along", topic="odom", field="pose.pose.position.x", low=0.0, high=20.0, bins=4, unit="m"),
        Sensor("sonar", topic="sonar", field="range", low=0.0, high=3.0, bins=5, unit="m"),
        Sensor("state", topic="runner/state", field="data", categories=["IDLE", "RUN", "HELD", "ARRIVED"]),
    ],
    drifts={"busy hall": Drift(BUSY)},
    episodes=200,
    min_success=0.97,
)
def test_runs(tarl, tarl_drift):
    """Run one tote to the end of the aisle."""
    aisle = Aisle(tarl.rng("aisle"), tarl_drift or 0.0)
    tarl.start("tote_runner.py")
    while not aisle.done:
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("parking_brake"))
        tarl.reward(aisle.judge())
    assert not aisle.failure, aisle.failure
