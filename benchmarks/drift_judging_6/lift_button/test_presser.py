"""A sprung finger presses a button. With the long finger for recessed panels the arm pushes too hard."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
PointStamped = message_type("geometry_msgs/msg/PointStamped")
String = message_type("std_msgs/msg/String")

DT = 0.1
UPPER, FOREARM = 0.34, 0.30
FINGERS = {"short": 0.09, "long": 0.135}  # m
LIGHTS, STOPS = 0.004, 0.027  # travel in m at which the button lights, and at which the spring is compressed
TIME_BOUND = 8.0


class Panel:
    """An arm in front of a panel."""

    def __init__(self, rng, finger):
        self.rng = rng
        self.name = finger
        self.finger = FINGERS[finger] + rng.normal(0.0, 0.0007)
        self.x = rng.uniform(0.50, 0.58)
        self.z = rng.uniform(0.05, 0.25)
        self.angles = [2.0, -2.2, 0.2]
        self.time = self.held = self.travel = 0.0
        self.pressed = False
        self.finished = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the press is over."""
        return self.finished or bool(self.failure)

    def publish(self, bus):
        """Publish the button position from the camera, the mounted finger, and the force on it."""
        seen = PointStamped()
        seen.point.x = self.x + self.rng.normal(0.0, 0.002)
        seen.point.z = self.z + self.rng.normal(0.0, 0.002)
        bus.publish("/panel/button", seen)
        bus.publish("/tool/name", String(data=self.name))
        bus.publish("/finger/force", Float64(data=max(0.0, 400.0 * self.travel + self.rng.normal(0.0, 0.3))))

    def advance(self, joints, finished):
        """Move the joints for one step."""
        self.time += DT
        if joints:
            self.angles = [
                now + 0.35 * (aim - now) + self.rng.normal(0.0, 0.0005)
                for now, aim in zip(self.angles, joints.data, strict=True)
            ]
        shoulder, elbow, wrist = self.angles
        tip = UPPER * math.cos(shoulder) + FOREARM * math.cos(shoulder + elbow)
        tip += self.finger * math.cos(shoulder + elbow + wrist)
        height = UPPER * math.sin(shoulder) + FOREARM * math.sin(shoulder + elbow)
        height += self.finger * math.sin(shoulder + elbow + wrist)
        self.travel = max(0.0, tip - self.x)
        on_button = abs(height - self.z) < 0.02 and self.travel > LIGHTS
        self.held = self.held + DT if on_button else 0.0
        self.pressed = self.pressed or self.held >= 0.25
        self.finished = bool(finished and finished.data)

    def judge(self, lit):
        """Return the reward of the step: 10 for a lit button, minus a cost of time."""
        if self.travel > STOPS:
            self.failure = f"protective stop at {1000 * self.travel:.0f} mm of travel"
        elif self.finished and not self.pressed:
            self.failure = "the button is not lit"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        if self.failure:
            return -5.0
        return -0.01 + 10.0 * (self.pressed and not lit)


@pytest.mark.tarl(
    nodes=["presser.py", "kinematics.py"],
    sensors=[
        Sensor("tool", topic="/tool/name", field="data", categories=("short", "long")),
        Sensor("force", topic="/finger/force", field="data", edges=(1.0, 5.0, 10.0), unit="N"),
        Sensor("height", topic="/panel/button", field="point.z", low=0.05, high=0.25, bins=2, unit="m"),
    ],
    drifts={"long finger": "long"},
    episodes=80,
    min_success=0.95,
)
def test_presses(tarl, tarl_drift):
    """Press one button."""
    panel = Panel(tarl.rng("panel"), tarl_drift or "short")
    tarl.start("presser.py")
    while not panel.done:
        lit = panel.pressed
        panel.publish(tarl.bus)
        tarl.step(DT)
        panel.advance(tarl.bus.latest("/arm/joints"), tarl.bus.latest("/press/finished"))
        tarl.reward(panel.judge(lit))
    assert not panel.failure, panel.failure
