"""The elbow reaches three angles in turn, with or without a tool; each step is rewarded by the error of the hand."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")
Bool = message_type("std_msgs/msg/Bool")
JointState = message_type("sensor_msgs/msg/JointState")

DT = 0.05
HOLD = 36  # number of steps per goal
NEAR = 0.1  # rad


class Arm:
    """An elbow whose hand picks up a tool of `tool` kg after some time."""

    def __init__(self, rng, tool):
        self.rng = rng
        self.tool = tool
        self.taken = int(rng.integers(8, 20))
        self.goals = [rng.uniform(-0.4, 0.9) for _ in range(3)]
        self.angle = self.goals[0] + rng.uniform(-0.1, 0.1)
        self.speed = 0.0
        self.steps = 0
        self.reached = [False] * 3

    @property
    def goal(self):
        """Return the target angle at this step."""
        return self.goals[min(2, self.steps // HOLD)]

    def publish(self, bus):
        """Publish the measurements of joint and hand."""
        bus.publish("/tool", Bool(data=self.tool > 0.0 and self.steps >= self.taken))
        bus.publish("/goal", Float64(data=self.goal))
        joint = JointState()
        joint.position = [self.angle + self.rng.normal(0.0, 0.002)]
        joint.velocity = [self.speed + self.rng.normal(0.0, 0.01)]
        bus.publish("/joint", joint)

    def advance(self, command):
        """Move for one step."""
        torque = max(-15.0, min(15.0, command.data)) if command else 0.0
        load = self.tool if self.steps >= self.taken else 0.0
        mass = 0.5 * 1.4 + 0.4 + load
        inertia = (0.3 * 1.4 + 0.4 + load) * 0.35**2 + 0.05
        push = torque - mass * 9.81 * 0.35 * math.cos(self.angle) - 0.3 * self.speed
        self.speed += push / inertia * DT
        self.angle += self.speed * DT
        self.steps += 1

    def judge(self):
        """Return the reward of the step."""
        off = abs(self.goals[(self.steps - 1) // HOLD] - self.angle)
        if self.steps % HOLD == 0:
            self.reached[self.steps // HOLD - 1] = off < NEAR
            return 2.0 if off < NEAR else -2.0
        return 0.05 * max(-1.0, 1.0 - off)


@pytest.mark.tarl(
    nodes=["elbow.py"],
    sensors=[
        Sensor("tool", topic="/tool", field="data"),
        Sensor("angle", topic="/joint", field="position.0", low=-1.0, high=1.5, bins=5, unit="rad"),
    ],
    drifts={"heavy tool": 0.6},
    episodes=100,
    min_success=0.95,
)
def test_reaches_its_goals(tarl, tarl_drift):
    """Be near each target angle when its time ends."""
    arm = Arm(tarl.rng("arm"), tarl_drift or 0.0)
    tarl.start("elbow.py")
    while arm.steps < 3 * HOLD:
        arm.publish(tarl.bus)
        tarl.step(DT)
        arm.advance(tarl.bus.latest("/torque"))
        tarl.reward(arm.judge())
    assert all(arm.reached), f"missed {arm.reached.count(False)} goals"
