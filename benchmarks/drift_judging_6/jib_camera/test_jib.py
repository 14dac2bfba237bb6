"""A camera pans to its mark in time for the shot and does not sway. The cinema camera has three times the inertia."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
JointState = message_type("sensor_msgs/msg/JointState")
String = message_type("std_msgs/msg/String")

DT = 0.02
BEARING = 14.0  # Nm s/rad
INERTIA = {"broadcast": 4.0, "cinema": 12.0}  # kg m^2
SHOT, LENGTH = 1.4, 4.5  # s
DRIVE = 0.1  # lag of the torque (s)
FRAME = 0.05  # rad
BEYOND = 0.06  # overshoot from which a viewer notices the swing (rad)


class Crane:
    """A jib with a camera."""

    def __init__(self, rng, camera):
        self.rng = rng
        self.camera = camera
        self.inertia = INERTIA[camera] * rng.uniform(0.95, 1.05)
        self.wind = rng.normal(0.0, 0.2)
        self.target = rng.choice([-1.0, 1.0]) * rng.uniform(0.8, 1.2)
        self.angle = rng.normal(0.0, 0.01)
        self.speed = self.torque = self.beyond = self.time = 0.0
        self.missed = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the shot is taken."""
        return self.time > LENGTH

    def publish(self, bus):
        """Publish the mark, the mounted camera, and the state of the joint."""
        bus.publish("jib/target", Float64(data=self.target))
        bus.publish("camera/model", String(data=self.camera))
        joint = JointState(name=["jib_tilt", "jib_pan"])
        joint.position = [0.0, self.angle + self.rng.normal(0.0, 0.001)]
        joint.velocity = [0.0, self.speed + self.rng.normal(0.0, 0.01)]
        bus.publish("joint_states", joint)

    def advance(self, torque):
        """Swing for one step."""
        self.time += DT
        aim = torque.data if torque else 0.0
        self.torque += (1.0 - math.exp(-DT / DRIVE)) * (aim - self.torque)
        push = self.torque + self.wind + self.rng.normal(0.0, 0.5)
        self.speed += (push - BEARING * self.speed) / self.inertia * DT
        self.angle += self.speed * DT

    def judge(self):
        """Return the reward of the step: at most 10 in total for a mark in the frame during the shot."""
        error = abs(self.target - self.angle)
        self.beyond = max(self.beyond, (self.angle - self.target) * math.copysign(1.0, self.target))
        if self.time < SHOT:
            return 0.0
        self.missed += error > FRAME
        if self.done and self.beyond > BEYOND:
            self.failure = f"swings {self.beyond:.2f} rad beyond the mark"
        elif self.done and self.missed * DT > 0.1:
            self.failure = f"out of the frame for {self.missed * DT:.1f} s"
        if self.failure:
            return -5.0
        return 10.0 * DT / (LENGTH - SHOT) * max(0.0, 1.0 - (error / FRAME) ** 2)


@pytest.mark.tarl(
    nodes=["jib.py"],
    sensors=[
        Sensor("camera", topic="camera/model", field="data", categories=("broadcast", "cinema")),
        Sensor("pan", topic="joint_states", field="position.1", low=-1.2, high=1.2, bins=6, unit="rad"),
    ],
    drifts={"cinema camera": "cinema"},
    episodes=80,
    min_success=0.95,
)
def test_pans(tarl, tarl_drift):
    """Pan to one mark."""
    crane = Crane(tarl.rng("crane"), tarl_drift or "broadcast")
    tarl.start("jib.py")
    while not crane.done:
        crane.publish(tarl.bus)
        tarl.step(DT)
        crane.advance(tarl.bus.latest("jib/torque"))
        tarl.reward(crane.judge())
    assert not crane.failure, crane.failure
