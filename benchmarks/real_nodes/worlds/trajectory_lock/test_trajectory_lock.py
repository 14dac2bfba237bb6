"""PR2's mannequin mode holds the head where a person leaves it. A heavy camera pulls the head down."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

State = message_type("pr2_controllers_msgs/JointTrajectoryControllerState")

PACKAGE = "pr2_mannequin_mode"
NODE = f"{PACKAGE}/scripts/trajectory_lock.py"
LAUNCH = f"{PACKAGE}/launch/trajectory_lock.launch"
SPACE = "/head_traj_controller_loose"
JOINTS = ["head_pan_joint", "head_tilt_joint"]
DT = 0.05
PUSH = (0.5, 3.0)  # from when to when the person moves the head, s
END = 7.0
NEAR = 0.28  # rad


class Head:
    """A head on a soft controller: `sag` rad is how far the weight pulls the tilt joint from its set point."""

    def __init__(self, rng, sag=0.03):
        self.rng = rng
        self.sag = (0.0, sag)
        self.wanted = (math.copysign(rng.uniform(0.3, 0.8), rng.normal()), rng.uniform(-0.3, 0.3))
        self.at = [0.0, -sag]
        self.held = [0.0, 0.0]
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the state of the controller."""
        state = State(joint_names=JOINTS)
        state.desired.positions = list(self.held)
        state.actual.positions = [one + self.rng.normal(0.0, 0.001) for one in self.at]
        state.error.positions = [
            held - at for held, at in zip(self.held, state.actual.positions, strict=True)
        ]
        bus.publish(f"{SPACE}/state", state)

    def follow(self, command):
        """Take a new set point."""
        self.held = list(command.points[-1].positions)

    def advance(self):
        """Move for one step."""
        pushing = PUSH[0] <= self.time < PUSH[1]
        for joint in range(2):
            rate = 4.0 * (self.held[joint] - self.at[joint] - self.sag[joint])
            if pushing:
                rate += 12.0 * (self.wanted[joint] - self.at[joint])
            self.at[joint] = max(-1.2, min(1.2, self.at[joint] + rate * DT))
        self.time += DT

    @property
    def off(self):
        """Return how far the head is from where the person left it, rad."""
        return max(abs(at - wanted) for at, wanted in zip(self.at, self.wanted, strict=True))

    def judge(self):
        """Return the reward of the step: for a head that stays."""
        if self.time >= END and self.off > NEAR:
            self.failure = "does not stay"
            return -5.0
        return 2.0 * DT if self.time > PUSH[1] and self.off < NEAR else 0.0


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor(
            "tilt",
            topic=f"{SPACE}/state",
            field="actual.positions[1]",
            low=-1.2,
            high=0.6,
            bins=6,
            unit="rad",
        ),
    ],
    drifts={"camera": Drift(0.1, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_stays_where_it_is_left(tarl, tarl_drift):
    """Move the head and let it go."""
    head = Head(tarl.rng("head"), **({"sag": tarl_drift} if tarl_drift else {}))
    tarl.bus.subscribe(f"{SPACE}/command", head.follow)
    tarl.launch(LAUNCH, only=[f"{SPACE}/traj_lock"])
    while head.time < END and not head.failure:
        head.publish(tarl.bus)
        tarl.step(DT)
        head.advance()
        tarl.reward(head.judge())
    assert not head.failure, head.failure
