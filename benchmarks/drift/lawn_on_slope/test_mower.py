"""The mower leaves no unmown grass along its strip, even on the slope."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/PointStamped")
Float32 = message_type("std_msgs/Float32")
Float64 = message_type("std_msgs/Float64")

DT = 0.1
LENGTH = 6.0
SLOPE = (2.0, 5.0)
STRIP = 0.16  # distance from the middle (m)


class Lawn:
    """A strip of lawn whose middle part may slope; there the robot slips sideways at `slide` m/s."""

    def __init__(self, rng, slide):
        self.rng = rng
        self.slide = slide
        self.x, self.y = 0.0, rng.uniform(-0.03, 0.03)
        self.heading = rng.uniform(-0.05, 0.05)
        self.turning = 0.0
        self.high = rng.uniform(0.0, 4.0)
        self.cut = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the strip is mown."""
        return self.x >= LENGTH

    @property
    def grass(self):
        """Return the height of the grass at the mower, cm."""
        return 15.0 if self.high <= self.x <= self.high + 1.0 else 7.0

    def publish(self, bus):
        """Publish the sensor readings."""
        place = PointStamped()
        place.point.x = self.x + self.rng.normal(0.0, 0.01)
        place.point.y = self.y + self.rng.normal(0.0, 0.01)
        bus.publish("/compass", Float64(data=self.heading + self.rng.normal(0.0, 0.01)))
        bus.publish("/grass", Float32(data=self.grass + self.rng.normal(0.0, 0.5)))
        bus.publish("/place", place)

    def advance(self, drive, blade):
        """Drive for one step."""
        speed, turn = (drive.linear.x, drive.angular.z) if drive else (0.0, 0.0)
        speed = max(0.0, min(0.8, speed))
        self.turning += (turn - self.turning) * 0.5
        self.heading += self.turning * DT
        slip = self.slide if SLOPE[0] <= self.x <= SLOPE[1] else 0.0
        self.gained = speed * math.cos(self.heading) * DT
        self.x += self.gained
        self.y += (speed * math.sin(self.heading) - slip) * DT
        self.cut = blade.data if blade else 0.0
        self.time += DT

    def judge(self):
        """Return the reward of the step, for each well mown metre."""
        if abs(self.y) > STRIP:
            self.failure = "left grass unmown"
        elif self.time > 20.0:
            self.failure = "late"
        if self.failure:
            return -4.0
        well = 1.0 if self.cut > 0.5 + 0.02 * self.grass else 0.3
        return 10.0 * well * self.gained / LENGTH


@pytest.mark.tarl(
    nodes=["mower.py", "steering.py"],
    sensors=[
        Sensor("along", topic="/place", field="point.x", low=0, high=6, bins=12, unit="m"),
        Sensor("grass", topic="/grass", field="data", low=0, high=20, bins=4, unit="cm"),
    ],
    drifts={"wet slope": 0.2},
    episodes=100,
    min_success=0.95,
)
def test_mows_the_strip(tarl, tarl_drift):
    """Mow all of the strip."""
    lawn = Lawn(tarl.rng("lawn"), tarl_drift or 0.0)
    tarl.start("mower.py")
    while not (lawn.done or lawn.failure):
        lawn.publish(tarl.bus)
        tarl.step(DT)
        lawn.advance(tarl.bus.latest("/cmd_vel"), tarl.bus.latest("/blade"))
        tarl.reward(lawn.judge())
    assert lawn.done, lawn.failure
