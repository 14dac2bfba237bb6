"""A lift lets people in. In a hospital some walk behind a frame, and the light curtain sees nobody in between.

A door that closes after the last guest earns, seconds cost a little, and a door that hits somebody is a large loss.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.1
OFFICE = {"frames": 0.0}
HOSPITAL = {"frames": 0.032}  # share of those who walk with a frame


class Floor:
    """A floor with some guests, of whom a share walks behind `frames`."""

    def __init__(self, rng, frames):
        self.rng = rng
        self.gap, self.width = 0.0, 1.1
        self.inside = float(rng.uniform(0.0, 250.0))  # kg
        self.crossings = []  # begin and end of what crosses the curtain, in s after the door is open
        self.weights = []
        at = float(rng.uniform(0.5, 1.5))
        for _ in range(int(rng.integers(3, 6))):
            walks_behind = rng.random() < frames
            if walks_behind:
                self.crossings.append((at, at + 0.5, False))
                at += 0.5 + float(rng.uniform(1.5, 1.9))
            lasts = float(rng.uniform(0.5, 0.8))
            self.crossings.append((at, at + lasts, walks_behind))
            self.weights.append((at + lasts, float(rng.uniform(55.0, 95.0))))
            at += lasts + float(rng.uniform(0.3, 0.7))
        self.last = self.crossings[-1][1]
        self.open_for = 0.0
        self.closing = False
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the door has closed."""
        return bool(self.failure) or self.over

    def crossing(self):
        """Return what is in the curtain: nothing, or whether it is somebody behind a frame."""
        now = self.open_for
        return next((behind for begin, end, behind in self.crossings if begin <= now < end), None)

    def publish(self, bus):
        """Publish the gap, the curtain, the cabin and the floor."""
        bus.publish("door/gap", Float32(data=self.gap + self.rng.normal(0.0, 0.002)))
        bus.publish("door/curtain", Bool(data=self.crossing() is not None))
        step = round(self.time / DT)
        if step % 5 == 0:
            load = self.inside + sum(weight for at, weight in self.weights if at < self.open_for)
            bus.publish("cabin/load", Float32(data=max(0.0, load + self.rng.normal(0.0, 3.0))))
        bus.publish("lift/at_floor", Bool(data=step >= 3))

    def advance(self, speed, mode):
        """Let one step pass."""
        self.time += DT
        self.gained = -0.004
        self.gap = max(0.0, min(self.width, self.gap + DT * (speed.data if speed else 0.0)))
        self.closing = bool(speed) and speed.data < 0.0
        if self.gap > 0.8 or self.open_for > 0.0:
            self.open_for += DT
        if self.closing and self.crossing() and self.gap < 1.06:
            self.failure = "door hits somebody"
        elif mode == "closed" and self.open_for > 1.0:
            self.over = True
            self.gained += 6.0
            if self.open_for < self.last:
                self.failure = "guest is left behind"
        elif self.time > 50.0:
            self.failure = "lift is stuck"
        if self.failure:
            self.gained -= 10.0


@pytest.mark.tarl(
    nodes=["lift_door.py"],
    sensors=[
        Sensor("gap", topic="door/gap", field="data", low=0.0, high=1.1, bins=5, unit="m"),
        Sensor("curtain", topic="door/curtain", field="data"),
        Sensor("load", topic="cabin/load", field="data", low=0.0, high=900.0, bins=6, unit="kg"),
    ],
    drifts={"hospital": HOSPITAL},
    episodes=200,
    min_success=0.97,
)
def test_lets_in(tarl, tarl_drift):
    """Let all guests in: 6 for a closed door, a small cost per second, -10 for a hit."""
    floor = Floor(tarl.rng("floor"), **(tarl_drift or OFFICE))
    tarl.start("lift_door.py")
    while not floor.done:
        floor.publish(tarl.bus)
        tarl.step(DT)
        mode = tarl.bus.latest("door/mode")
        floor.advance(tarl.bus.latest("door/speed"), mode.data if mode else "")
        tarl.reward(floor.gained)
    assert not floor.failure, floor.failure
