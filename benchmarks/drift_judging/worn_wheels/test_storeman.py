"""The robot stops at its shelf.

The tyres of the robot wear down permanently, and no sensor measures the wear.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
Int32MultiArray = message_type("std_msgs/Int32MultiArray")

DT = 0.1
TICKS = 1200.0  # ticks per metre of tread with new tyres
TRACK = 0.42
REACH = 0.14  # distance from the shelf at which a box can still be taken, m
TIME_BOUND = 18.0


class Aisle:
    """An aisle; `tyre` is the radius of the wheels as a share of that of new wheels."""

    def __init__(self, rng, tyre):
        self.rng = rng
        self.tyre = tyre * rng.uniform(0.99, 1.01)
        self.shelf = rng.uniform(1.6, 2.8)
        self.x, self.y, self.heading = 0.0, 0.0, rng.uniform(-0.02, 0.02)
        self.ticks = [float(rng.integers(0, 5000)), float(rng.integers(0, 5000))]
        self.speed = 0.0
        self.time = 0.0
        self.failure = ""
        self.arrived = False

    def publish(self, bus):
        """Publish the order and the counts of the encoders."""
        bus.publish("/shelf", Float64(data=self.shelf))
        bus.publish("/ticks", Int32MultiArray(data=[int(count) for count in self.ticks]))

    def advance(self, drive, there):
        """Roll for one step; the motors turn the wheels at the rate that is right for new tyres."""
        speed, turn = (drive.linear.x, drive.angular.z) if drive else (0.0, 0.0)
        self.speed += (max(0.0, min(0.6, speed)) - self.speed) * 0.5
        for side, sign in ((0, -1.0), (1, 1.0)):
            wheel = (self.speed + sign * turn * TRACK / 2) * (1 + self.rng.normal(0.0, 0.02))
            self.ticks[side] += wheel * DT * TICKS
        self.heading += turn * self.tyre * DT + self.rng.normal(0.0, 0.001)
        self.x += self.speed * self.tyre * math.cos(self.heading) * DT
        self.y += self.speed * self.tyre * math.sin(self.heading) * DT
        self.time += DT
        self.arrived = bool(there and there.data)

    def judge(self):
        """Return the reward of the step: time costs, the right place is rewarded."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        miss = math.hypot(self.x - self.shelf, self.y)
        if self.arrived and miss > REACH:
            self.failure = f"stopped {miss:.2f} m away from the shelf"
        if self.failure:
            return -5.0
        return 10.0 - 4.0 * miss if self.arrived else -0.005


@pytest.mark.tarl(
    nodes=["storeman.py", "odometry.py"],
    sensors=[
        Sensor("shelf", topic="/shelf", field="data", low=1.5, high=3, bins=3, unit="m"),
        Sensor("counted", topic="/ticks", field="data.0", low=0, high=9000, bins=6),
    ],
    drifts={"worn tyres": Drift(0.83, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_stops_at_the_shelf(tarl, tarl_drift):
    """Drive to the shelf with the box."""
    aisle = Aisle(tarl.rng("aisle"), tarl_drift or 1.0)
    tarl.start("storeman.py")
    while not (aisle.arrived or aisle.failure):
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("/cmd_vel"), tarl.bus.latest("/there"))
        tarl.reward(aisle.judge())
    assert not aisle.failure, aisle.failure
