"""A shaker shakes plums off a tree. In a young orchard, trunks are stiffer, and their bark is soft."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
OLD = {"resonance": 13.5, "bark": 0.78}
YOUNG = {"resonance": 19.3, "bark": 0.62}  # Hz; largest load


class Tree:
    """A tree with a `resonance`, in Hz, and a `bark` that bears some load."""

    def __init__(self, rng, resonance, bark):
        self.rng = rng
        self.resonance = resonance + float(rng.uniform(-0.5, 0.5))
        self.bark = bark * rng.normal(1.0, 0.015)
        self.hanging, self.frequency, self.throw = 1.0, 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the tree is released."""
        return bool(self.failure) or self.over

    def load(self):
        """Return the load of the bark."""
        return self.throw * (self.frequency / 16.0) ** 2

    def publish(self, bus):
        """Publish the clamp once and the load cell of the clamp."""
        if round(self.time / DT) == 2:
            bus.publish("clamp/closed", Bool(data=True))
        bus.publish("clamp/load", Float32(data=abs(self.load() + self.rng.normal(0.0, 0.01))))

    def advance(self, frequency, throw, phase):
        """Shake for one step."""
        self.time += DT
        self.gained = 0.0
        self.frequency += 0.7 * ((frequency.data if frequency else 0.0) - self.frequency)
        self.throw += 0.5 * ((throw.data if throw else 0.0) - self.throw)
        sway = (1.0 + (self.frequency - self.resonance) ** 2) ** -2
        fall = self.hanging * min(1.0, DT * 14.0 * self.throw * sway)
        self.hanging -= fall
        self.gained += 2.0 * fall
        if self.load() > self.bark:
            self.failure = "bark comes off"
        elif self.time > 11.0:
            self.failure = "shaker does not let go"
        elif phase and phase.data == "release":
            self.over = True
            self.gained += 6.0 * min(1.0, (1.0 - self.hanging) / 0.88)
            if self.hanging > 0.22:
                self.failure = "plums stay on the tree"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["tree_shaker.py"],
    sensors=[
        Sensor("load", topic="clamp/load", field="data", low=0.0, high=1.0, bins=8),
    ],
    drifts={"young": YOUNG},
    episodes=200,
    min_success=0.97,
)
def test_shakes(tarl, tarl_drift):
    """Shake one tree."""
    tree = Tree(tarl.rng("tree"), **(tarl_drift or OLD))
    tarl.start("tree_shaker.py")
    while not tree.done:
        tree.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        tree.advance(bus.latest("shaker/frequency"), bus.latest("shaker/throw"), bus.latest("shaker/phase"))
        tarl.reward(tree.gained)
    assert not tree.failure, tree.failure
