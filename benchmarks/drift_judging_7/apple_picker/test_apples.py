"""Apples come off after some twisting. In a dry year, a few trees have tough stems that need more twisting."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
String = message_type("std_msgs/msg/String")

DT = 0.1
APPLES = 3
TIME_BOUND = 32.0


class Tree:
    """A tree with apples whose stems wear when twisted."""

    def __init__(self, rng, tough):
        self.rng = rng
        hard = rng.random() < tough
        self.stems = [rng.uniform(6.0, 9.5) for _ in range(APPLES)]  # twist that a stem bears (rad)
        if hard:
            self.stems[int(rng.integers(APPLES))] = rng.uniform(17.0, 24.0)
        self.number, self.twisted, self.arrives = 0, 0.0, 0.6
        self.time = 0.0
        self.event = ""
        self.lost = self.picked = 0
        self.torque = 0.0
        self.released = None

    @property
    def done(self):
        """Return whether all apples are done, or the time is over."""
        return self.number >= APPLES or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish the torque and the state of the arm."""
        bus.publish("wrist/torque", Float32(data=self.torque + self.rng.normal(0.0, 0.02)))
        if self.event:
            bus.publish("arm/event", String(data=self.event))
            self.event = ""

    def following(self):
        """Move on to the next apple."""
        self.number += 1
        self.twisted, self.arrives = 0.0, self.rng.uniform(0.4, 0.8)

    def advance(self, wrist, released):
        """Twist the stem and return the reward of the step."""
        self.time += DT
        if self.arrives > 0.0:
            self.arrives -= DT
            if self.arrives <= 0.0:
                self.event = "at_apple"
            return -0.005
        if wrist is None:
            return 0.0
        self.twisted += abs(wrist.x) * DT
        self.torque = 0.1 * abs(wrist.x)
        if self.twisted >= self.stems[self.number]:
            self.picked += 1
            self.event = "loose"
            self.following()
            return 10.0 / APPLES - 0.005
        if released:
            self.lost += 1
            self.following()
            return -4.0
        return -0.005


@pytest.mark.tarl(
    nodes=["apple_picker.py"],
    sensors=[
        Sensor("torque", topic="wrist/torque", field="data", low=0, high=0.3, bins=3, unit="Nm"),
        Sensor("event", topic="arm/event", field="data", categories=("at_apple", "loose")),
    ],
    drifts={"dry year": 0.11},
    episodes=150,
    min_success=0.95,
)
def test_picks(tarl, tarl_drift):
    """Pick the apples of one branch."""
    tree = Tree(tarl.rng("tree"), tarl_drift or 0.0)
    tarl.start("apple_picker.py")
    last = None
    while not tree.done:
        tree.publish(tarl.bus)
        tarl.step(DT)
        command = tarl.bus.latest("gripper/command")
        released = command is not None and command is not last and command.data == "release"
        last = command
        tarl.reward(tree.advance(tarl.bus.latest("wrist/command"), released))
    assert tree.picked == APPLES, f"{tree.lost} apples stayed on the tree"
