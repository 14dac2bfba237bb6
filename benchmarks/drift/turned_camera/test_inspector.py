"""The seam stays in view to its end. A camera that is mounted upside down swaps left and right."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32MultiArray = message_type("std_msgs/Float32MultiArray")
Bool = message_type("std_msgs/Bool")

DT = 0.1
LENGTH = 1.6
VIEW = 0.12  # half of the camera's field of view, m


class Seam:
    """A seam that bends gently; `side` is -1 if the camera hangs upside down."""

    def __init__(self, rng, side):
        self.rng = rng
        self.side = side
        self.bend = rng.uniform(-0.04, 0.04)
        self.x, self.y = 0.0, rng.uniform(-0.02, 0.02)
        self.heading = rng.uniform(-0.05, 0.05)
        self.wide = rng.uniform(0.2, 1.2)
        self.time = 0.0
        self.gained = 0.0
        self.failure = ""

    @property
    def offset(self):
        """Return the distance to the seam, left positive, m."""
        return self.bend * math.sin(4.0 * self.x) - self.y

    def publish(self, bus):
        """Publish the measurements of the camera and of its mount."""
        bus.publish("/upright", Bool(data=self.side > 0))
        half = 35.0 if 0.0 <= self.x - self.wide <= 0.2 else 15.0
        middle = 160.0 + self.side * self.offset / 0.001 + self.rng.normal(0.0, 0.3)
        bus.publish("/seam", Float32MultiArray(data=[middle - half, middle + half]))

    def advance(self, command):
        """Drive for one step."""
        speed, turn = (command.linear.x, command.angular.z) if command else (0.0, 0.0)
        self.heading += turn * DT
        self.gained = max(0.0, min(0.3, speed)) * math.cos(self.heading) * DT
        self.x += self.gained
        self.y += speed * math.sin(self.heading) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress, with a larger weight near the seam."""
        if abs(self.offset) > VIEW:
            self.failure = "lost the seam"
        elif self.time > 14.0:
            self.failure = "late"
        if self.failure:
            return -3.0
        return (10.0 - 3.0 * abs(self.offset) / VIEW) * self.gained / LENGTH


@pytest.mark.tarl(
    nodes=["inspector.py"],
    sensors=[
        Sensor("upright", topic="/upright", field="data"),
        Sensor("left", topic="/seam", field="data.0", low=0, high=320, bins=8, unit="px"),
    ],
    drifts={"upside down": -1.0},
    episodes=100,
    min_success=0.95,
)
def test_follows_the_seam(tarl, tarl_drift):
    """Stay with the seam."""
    seam = Seam(tarl.rng("seam"), tarl_drift or 1.0)
    tarl.start("inspector.py")
    while seam.x < LENGTH and not seam.failure:
        seam.publish(tarl.bus)
        tarl.step(DT)
        seam.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(seam.judge())
    assert not seam.failure, seam.failure
