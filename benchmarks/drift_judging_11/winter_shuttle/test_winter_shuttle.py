"""A shuttle bus drives its route. On ice it slides past stops and out of bends."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Odometry = message_type("nav_msgs/msg/Odometry")

DT = 0.25
LENGTH = 120.0
STOPS = [50.0, 105.0]
BENDS = [(8.0, 20.0, 12.0), (70.0, 82.0, 15.0)]
NEAR = 2.0  # distance from a stop (m)
TIME_BOUND = 49.5


class Route:
    """A route with stops and bends; `grip` is the largest acceleration of the tyres, m/s²."""

    def __init__(self, rng, grip, road):
        self.rng = rng
        self.grip = grip * rng.normal(1.0, 0.02)
        self.road = road + rng.uniform(-1.0, 1.0)
        self.s, self.v = 0.0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.served = [False, False]
        self.slid = [False, False]
        self.passed = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the trip has ended."""
        return self.s >= LENGTH or self.failure == "late"

    def publish(self, bus):
        """Publish odometry and the temperature of the road."""
        odom = Odometry()
        odom.pose.pose.position.x = self.s + self.rng.normal(0.0, 0.05)
        odom.twist.twist.linear.x = self.v + self.rng.normal(0.0, 0.03)
        bus.publish("odom", odom)
        bus.publish("road/temperature", Float32(data=self.road + self.rng.normal(0.0, 0.3)))

    def advance(self, cmd):
        """Drive for one step."""
        push = cmd.data if cmd else 0.0
        push = max(-self.grip, min(self.grip, push)) + self.rng.normal(0.0, 0.05)
        self.v = max(0.0, self.v + push * DT)
        self.s += self.v * DT
        self.time += DT
        self.gained = 0.0
        for index, place in enumerate(STOPS):
            if not self.served[index] and self.v < 0.2 and abs(self.s - place) < NEAR:
                self.served[index] = True
                self.gained += 2.5
        for index, (start, end, radius) in enumerate(BENDS):
            if start < self.s < end and self.v**2 / radius > self.grip and not self.slid[index]:
                self.slid[index] = True
            if self.passed == index and self.s >= end:
                self.passed += 1
                self.gained += 0.0 if self.slid[index] else 2.5

    def judge(self):
        """Return the reward of the step: stops served and bends passed in lane."""
        if self.s >= LENGTH:
            if any(self.slid):
                self.failure = "slides out of a bend"
            elif not all(self.served):
                self.failure = "misses a stop"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return self.gained - 0.002 - (2.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["winter_shuttle.py"],
    sensors=[
        Sensor("road", topic="road/temperature", field="data", low=-10.0, high=20.0, bins=6, unit="°C"),
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=0.0, high=8.0, bins=4, unit="m/s"),
    ],
    drifts={"ice": 1.0},
    episodes=200,
    min_success=0.97,
)
def test_drives_the_route(tarl, tarl_drift):
    """Drive the route once."""
    route = Route(tarl.rng("route"), tarl_drift or 4.5, -6.0 if tarl_drift else 9.0)
    tarl.start("winter_shuttle.py")
    while not route.done:
        route.publish(tarl.bus)
        tarl.step(DT)
        route.advance(tarl.bus.latest("accelerator"))
        tarl.reward(route.judge())
    assert not route.failure, route.failure
