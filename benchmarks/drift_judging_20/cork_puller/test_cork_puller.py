"""A machine opens wine. The cellar sends old vintages, whose corks are longer; only the open bottle counts."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
JointState = message_type("sensor_msgs/JointState")
WrenchStamped = message_type("geometry_msgs/WrenchStamped")

DT = 0.05
YOUNG, VINTAGE = 0.044, 0.054  # m, length of the cork
PITCH = 0.008  # m per turn


class Bottle:
    """A bottle with a cork of `length`; less than two thirds of it on the screw, and the cork tears."""

    def __init__(self, rng, length):
        self.rng = rng
        self.length = length + rng.normal(0.0, 0.0005)
        self.grip = rng.uniform(190.0, 260.0)  # N, of a whole cork
        self.strong = rng.normal(0.68, 0.012)
        self.gap, self.turns = rng.uniform(0.004, 0.012), 0.0
        self.lift, self.tight, self.press, self.out = 0.0, 0.0, 0.0, 0.0
        self.time, self.failure, self.over = 0.0, "", False

    @property
    def done(self):
        """Return whether the bottle is open, or spoilt."""
        return bool(self.failure) or self.over

    @property
    def depth(self):
        """Return the length of the screw in the cork."""
        return PITCH * self.turns - self.gap

    def publish(self, bus):
        """Publish the joints, the force of the lift and the clamp."""
        screw = 2.0 * math.pi * self.turns + self.rng.normal(0.0, 0.02)
        bus.publish("joint_states", JointState(name=["screw", "lift"], position=[screw, self.lift]))
        force = WrenchStamped()
        standing = -self.press if self.depth > 0.0 and self.lift == 0.0 else 0.0
        force.wrench.force.z = self.tight + standing + self.rng.normal(0.0, 1.0)
        bus.publish("lift/force", force)
        bus.publish("bottle/clamped", Bool(data=self.time > 0.5))

    def advance(self, screw, lift, press, state):
        """Turn and pull for one step; the cork gives way when the pull is more than its grip."""
        self.turns += DT * (screw.data if screw else 0.0)
        self.press = press.data if press else 0.0
        rise = DT * (lift.data if lift else 0.0)
        self.lift += rise
        self.time += DT
        left = max(0.0, 1.0 - self.out / self.length)
        if rise > 0.0 and self.depth > 0.0:
            self.tight = min(self.tight + 40000.0 * rise, self.grip * left)
            if self.tight >= self.grip * left:
                self.out += rise
        if self.depth > self.length:
            self.failure = "screw comes out below, crumbs in the wine"
        elif self.tight > 0.7 * self.grip and self.depth < self.strong * self.length:
            self.failure = "cork tears, and its end stays in the neck"
        elif (state and state.data == "stuck") or self.time > 25.0:
            self.failure = "bottle stays shut"
        elif state and state.data == "open" and self.out > 0.9 * self.length:
            self.over = True

    def judge(self):
        """Return the reward of the step: an open bottle."""
        return 10.0 if self.over else 0.0


@pytest.mark.tarl(
    nodes=["cork_puller.py"],
    sensors=[
        Sensor("pull", topic="lift/force", field="wrench.force.z", low=-30.0, high=300.0, bins=5, unit="N"),
        Sensor("clamped", topic="bottle/clamped", field="data"),
    ],
    drifts={"vintage": VINTAGE},
    episodes=200,
    min_success=0.97,
)
def test_opens(tarl, tarl_drift):
    """Open one bottle."""
    bottle = Bottle(tarl.rng("bottle"), tarl_drift or YOUNG)
    tarl.start("cork_puller.py")
    while not bottle.done:
        bottle.publish(tarl.bus)
        tarl.step(DT)
        topics = ("screw/speed", "lift/speed", "bell/press", "opener/state")
        bottle.advance(*(tarl.bus.latest(topic) for topic in topics))
        tarl.reward(bottle.judge())
    assert not bottle.failure, bottle.failure
