"""JSK's head_teleop_joy_completion.py turns a pull on a lever into the walk of a led robot. A stiff one gives less."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Joy = message_type("sensor_msgs/Joy")

PACKAGE = "jsk_robot_common/jsk_robot_startup"
NODE = f"{PACKAGE}/scripts/head_teleop_joy_completion.py"
LAUNCH = f"{PACKAGE}/launch/head_teleop.launch"
DT = 0.1
SCALE = 0.5  # m/s for an axis of 1, as in head_teleop_twist_joy.yaml
LEASH = 0.8  # m: the pull is full at this distance
TIME_BOUND = 20.0


class Leash:
    """A guide walks ahead along a curve; the robot walks as the completed lever says."""

    def __init__(self, rng, give=1.0):
        self.rng = rng
        self.give = give
        self.x, self.y, self.heading = 0.0, 0.0, 0.0
        self.guide = [0.5, 0.0]
        self.course = rng.uniform(-0.1, 0.1)
        self.bend = rng.uniform(-0.08, 0.08)
        self.pace = rng.uniform(0.28, 0.34)
        self.time = 0.0
        self.failure = ""

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish the lever: forward and left pull, from -1 to 1."""
        dx, dy = self.guide[0] - self.x, self.guide[1] - self.y
        ahead = math.cos(self.heading) * dx + math.sin(self.heading) * dy
        left = -math.sin(self.heading) * dx + math.cos(self.heading) * dy
        pull = [
            self.give * max(-1.0, min(1.0, one / LEASH)) + self.rng.normal(0.0, 0.01) for one in (ahead, left)
        ]
        bus.publish("/joy_head/joy_raw", Joy(axes=[*pull, 0.0], buttons=[0, 0]))

    def advance(self, joy):
        """Walk for one step."""
        forward, turn = (joy.axes[0], joy.axes[2]) if joy and joy.buttons[0] else (0.0, 0.0)
        speed = SCALE * max(0.0, min(1.0, forward))
        self.heading += max(-1.0, min(1.0, turn)) * DT
        self.x += speed * math.cos(self.heading) * DT
        self.y += speed * math.sin(self.heading) * DT
        self.course += self.bend * DT
        self.guide[0] += self.pace * math.cos(self.course) * DT
        self.guide[1] += self.pace * math.sin(self.course) * DT
        self.away = math.hypot(self.guide[0] - self.x, self.guide[1] - self.y)
        self.time += DT

    def judge(self):
        """Return the reward of the step: for walking near the guide, but not on its heels."""
        if self.away > 1.5:
            self.failure = "left behind"
        elif self.away < 0.1:
            self.failure = "on the heels"
        return -5.0 if self.failure else 0.05 * max(0.0, 1.0 - abs(self.away - 0.5))


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("pull", topic="/joy_head/joy_raw", field="axes[0]", low=0.0, high=1.0, bins=5),
        Sensor("left", topic="/joy_head/joy_raw", field="axes[1]", low=-0.5, high=0.5, bins=4),
    ],
    drifts={"stiff lever": Drift({"give": 0.4}, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_follows_its_guide(tarl, tarl_drift):
    """Walk on the leash."""
    leash = Leash(tarl.rng("leash"), **(tarl_drift or {}))
    tarl.launch(LAUNCH, only=["head_teleop_joy_completion"])
    while not leash.over:
        leash.publish(tarl.bus)
        tarl.step(DT)
        leash.advance(tarl.bus.latest("/joy_head/joy_complemented"))
        tarl.reward(leash.judge())
    assert not leash.failure, leash.failure
