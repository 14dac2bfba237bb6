"""Parts are grasped by their middle. Somebody has knocked against the camera, which stays in its new place."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Point = message_type("geometry_msgs/msg/Point")

DT = 0.05
SCALE = 0.0005  # m per pixel
MIDDLE = (0.12, 0.05)  # calibrated middle of the picture, m
GRASP = 0.016  # distance from the part's middle (m)
TIME_BOUND = 6.0


class Tray:
    """A part on a tray below a camera that may be shifted along x, m."""

    def __init__(self, rng, shift):
        self.rng = rng
        self.middle = (MIDDLE[0] + shift, MIDDLE[1])
        self.part = (MIDDLE[0] + rng.uniform(-0.07, 0.07), MIDDLE[1] + rng.uniform(-0.05, 0.05))
        self.x, self.y = rng.uniform(-0.05, 0.0), rng.uniform(-0.1, 0.1)
        self.vx, self.vy = 0.0, 0.0
        self.time = 0.0
        self.closed = False
        self.failure = ""

    @property
    def away(self):
        """Return the distance of the gripper from the middle of the part."""
        return math.hypot(self.part[0] - self.x, self.part[1] - self.y)

    def publish(self, bus):
        """Publish the measurements of camera and encoders."""
        seen = Point()
        seen.x = 320.0 + (self.part[0] - self.middle[0]) / SCALE + self.rng.normal(0.0, 1.5)
        seen.y = 240.0 + (self.part[1] - self.middle[1]) / SCALE + self.rng.normal(0.0, 1.5)
        bus.publish("/part", seen)
        bus.publish("/gripper", Point(x=self.x, y=self.y))

    def advance(self, velocity, close):
        """Move for one step with some inertia."""
        if velocity:
            self.vx += (velocity.x - self.vx) * 0.6
            self.vy += (velocity.y - self.vy) * 0.6
        self.before = self.away
        self.x += self.vx * DT
        self.y += self.vy * DT
        self.time += DT
        self.closed = bool(close and close.data)

    def judge(self):
        """Return the reward of the step: a little for approaching, most for a good grasp."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.closed and self.away > GRASP:
            self.failure = f"closed {self.away * 1000:.0f} mm away from the part"
        if self.failure:
            return -6.0
        grasp = 9.0 - 40.0 * self.away if self.closed else 0.0
        return 4.0 * (self.before - self.away) + grasp


@pytest.mark.tarl(
    nodes=["picker.py"],
    sensors=[
        Sensor("column", topic="/part", field="x", low=120, high=520, bins=8, unit="px"),
        Sensor("gripper", topic="/gripper", field="x", low=-0.06, high=0.22, bins=7, unit="m"),
    ],
    drifts={"knocked camera": Drift(-0.05, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_grasps(tarl, tarl_drift):
    """Close the fingers on the part."""
    tray = Tray(tarl.rng("tray"), tarl_drift or 0.0)
    tarl.start("picker.py")
    while not (tray.closed or tray.failure):
        tray.publish(tarl.bus)
        tarl.step(DT)
        tray.advance(tarl.bus.latest("/velocity"), tarl.bus.latest("/close"))
        tarl.reward(tray.judge())
    assert not tray.failure, tray.failure
