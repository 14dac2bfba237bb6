"""A courier robot is driven over a network. When the hotel is full, the network is slow."""

import math
from collections import deque

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Pose2D = message_type("geometry_msgs/msg/Pose2D")

DT = 0.1
WALL = 0.55  # maximum distance of the robot's middle from the middle line (m)
TIME_BOUND = 45.0
QUIET, FULL = 0.1, 0.7  # delays of a round trip (s)


class Corridor:
    """A robot in a corridor, whose poses and commands are under way for `delay` seconds together."""

    def __init__(self, rng, delay):
        self.rng = rng
        self.delay = delay * rng.uniform(0.95, 1.05)
        self.door = rng.uniform(14.0, 18.0)
        self.x, self.y = 0.0, rng.uniform(-0.2, 0.2)
        self.theta = rng.uniform(-0.15, 0.15)
        self.lag = rng.uniform(0.12, 0.18)
        self.v, self.turn, self.carpet = 0.0, 0.0, 0.0
        self.under_way = deque([(0.0, 0.0)] * round(self.delay / DT))
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the robot stands at the door, or was stopped."""
        return bool(self.failure) or (self.door - self.x < 0.4 and self.v < 0.05)

    def publish(self, bus):
        """Publish the pose, the number of the door as a distance, and the time of a ping."""
        seen = Pose2D(x=self.x + self.rng.normal(0.0, 0.02), y=self.y + self.rng.normal(0.0, 0.01))
        seen.theta = self.theta + self.rng.normal(0.0, 0.01)
        bus.publish("courier/pose", seen)
        bus.publish("courier/door", Float32(data=self.door))
        bus.publish("network/round_trip", Float32(data=self.delay + abs(self.rng.normal(0.0, 0.02))))

    def advance(self, command):
        """Drive for one step on the command that arrives now."""
        self.under_way.append((command.linear.x, command.angular.z) if command else (0.0, 0.0))
        v, turn = self.under_way.popleft()
        share = 1.0 - math.exp(-DT / self.lag)
        self.v += (v - self.v) * share
        self.turn += (turn - self.turn) * share
        self.carpet = 0.9 * self.carpet + self.rng.normal(0.0, 0.01)
        before = self.x
        self.theta += (self.turn + self.v * self.carpet) * DT
        self.x += self.v * math.cos(self.theta) * DT
        self.y += self.v * math.sin(self.theta) * DT
        self.time += DT
        self.gained = 10.0 * (self.x - before) / self.door * (1.0 - (self.y / WALL) ** 2) - 0.005

    def judge(self):
        """Return the reward of the step: way along the corridor, in its middle."""
        if abs(self.y) > WALL:
            self.failure = f"the robot hits the wall after {self.x:.1f} m"
        elif self.time > TIME_BOUND:
            self.failure = "the meal is cold"
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["hotel_courier.py"],
    sensors=[
        Sensor("aside", topic="courier/pose", field="y", low=-0.6, high=0.6, bins=6, unit="m"),
        Sensor("along", topic="courier/pose", field="x", low=0.0, high=18.0, bins=3, unit="m"),
        Sensor("ping", topic="network/round_trip", field="data", low=0.0, high=1.0, bins=5, unit="s"),
    ],
    drifts={"full hotel": Drift(FULL)},
    episodes=200,
    min_success=0.97,
)
def test_delivers(tarl, tarl_drift):
    """Bring one meal to a door."""
    corridor = Corridor(tarl.rng("corridor"), tarl_drift or QUIET)
    tarl.start("hotel_courier.py")
    while not corridor.done:
        corridor.publish(tarl.bus)
        tarl.step(DT)
        corridor.advance(tarl.bus.latest("courier/cmd_vel"))
        tarl.reward(corridor.judge())
    assert not corridor.failure, corridor.failure
