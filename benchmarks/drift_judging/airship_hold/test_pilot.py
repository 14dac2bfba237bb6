"""The airship reaches its mast. No repair is possible in a wind that is faster than the airship."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PoseStamped = message_type("geometry_msgs/PoseStamped")
Float64 = message_type("std_msgs/Float64")

DT = 0.5
FASTEST = 1.6  # largest speed through the air (m/s)
TIME_BOUND = 60.0


class Sky:
    """A sky with wind that blows from the mast, m/s."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.wind = wind + rng.uniform(-0.1, 0.1)
        self.x, self.y = 0.0, rng.uniform(-4.0, 4.0)
        self.heading, self.speed = rng.uniform(-0.3, 0.3), 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def away(self):
        """Return the distance to the mast, m."""
        return math.hypot(20.0 - self.x, self.y)

    @property
    def moored(self):
        """Return whether the mast can catch the ship."""
        return self.away < 0.8

    def publish(self, bus):
        """Publish the measurements of satellite receiver, compass and wind gauge."""
        pose = PoseStamped()
        pose.pose.position.x = self.x + self.rng.normal(0.0, 0.05)
        pose.pose.position.y = self.y + self.rng.normal(0.0, 0.05)
        bus.publish("/wind", Float64(data=self.wind + self.rng.normal(0.0, 0.05)))
        bus.publish("/compass", Float64(data=self.heading + self.rng.normal(0.0, 0.01)))
        bus.publish("/pose", pose)

    def advance(self, cmd):
        """Fly for one step; the propeller has a limit."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.speed += (max(0.0, min(FASTEST, speed)) - self.speed) * 0.5
        self.heading += max(-0.5, min(0.5, turn)) * DT
        self.before = self.away
        self.x += (self.speed * math.cos(self.heading) - self.wind) * DT
        self.y += self.speed * math.sin(self.heading) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step."""
        if self.time > TIME_BOUND or self.away > 40.0:
            self.failure = "does not reach the mast"
            return -5.0
        return 0.4 * (self.before - self.away) + (2.0 if self.moored else 0.0)


@pytest.mark.tarl(
    nodes=["pilot.py"],
    sensors=[
        Sensor("wind", topic="/wind", field="data", low=-0.5, high=3, bins=7, unit="m/s"),
        Sensor("along", topic="/pose", field="pose.position.x", low=-20, high=20, bins=8, unit="m"),
    ],
    drifts={"storm": 2.1},
    episodes=100,
    min_success=0.95,
)
def test_moors(tarl, tarl_drift):
    """Reach the mast."""
    sky = Sky(tarl.rng("sky"), tarl_drift or 0.0)
    tarl.start("pilot.py")
    while not (sky.moored or sky.failure):
        sky.publish(tarl.bus)
        tarl.step(DT)
        sky.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(sky.judge())
    assert sky.moored, sky.failure
