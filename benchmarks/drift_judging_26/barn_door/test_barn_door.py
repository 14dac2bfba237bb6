"""A motor slides the door of a barn. Straw and mud in the rail brake it, and it takes them for an obstacle.

A door that closes earns, seconds cost a little, and a squeezed animal or a door that gives up is a loss.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
CLEAN = {"friction": 70.0}
MUDDY = {"friction": Drift.range(150.0, 200.0)}  # N
AMPS = 0.028  # A per N


class Barn:
    """A door with some `friction`; at times a calf stands in the way until it is touched."""

    def __init__(self, rng, friction):
        self.rng = rng
        self.friction = friction * rng.normal(1.0, 0.02)
        self.at, self.speed = 3.2, 0.0
        self.calf = float(rng.uniform(0.9, 2.2)) if rng.random() < 0.35 else None  # m
        self.touched = 0.0
        self.force = 0.0
        self.seam = float(rng.uniform(0.5, 2.5))  # m, a joint of the rail
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the door has done its work."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish position and current, and once the button of the remote control."""
        step = round(self.time / DT)
        bus.publish("door/position", Float32(data=self.at + self.rng.normal(0.0, 0.003)))
        bus.publish("door/current", Float32(data=abs(AMPS * self.force) + abs(self.rng.normal(0.0, 0.1))))
        if step == 2:
            bus.publish("remote/open", Bool(data=True))
        elif step == 6:
            bus.publish("remote/open", Bool(data=False))

    def push(self):
        """Return the force of an animal or a joint of the rail against the door, and squeeze the animal."""
        extra = 12.0 if abs(self.at - self.seam) < 0.06 else 0.0
        if self.calf is None or self.at > self.calf + 0.02 or self.at < self.calf - 0.4:
            return extra
        depth = self.calf + 0.02 - self.at
        squeeze = 900.0 * depth
        self.touched += DT
        if squeeze > 290.0:
            self.failure = "calf is squeezed"
        return extra + squeeze

    def advance(self, command, state):
        """Move the door for one step."""
        self.time += DT
        self.gained = -0.003
        wanted = command.data if command else 0.0
        before = self.speed
        self.speed += 0.5 * (wanted - self.speed)
        against = self.push() if self.speed < 0.0 else 0.0
        if abs(self.speed) > 0.01:
            accelerating = 60.0 * (abs(self.speed) - abs(before)) / DT
            self.force = max(0.0, self.friction + accelerating + against)
        else:
            self.force = 0.0
        slowed = max(0.2, 1.0 - against / 330.0)
        self.at = max(0.0, min(3.2, self.at + DT * self.speed * slowed))
        if self.calf is not None and self.touched > 0.05 and self.at > self.calf + 0.04:
            self.calf = None  # it walks away
        if state == "rest" and self.time > 3.0 and self.at < 0.05:
            self.over = True
            self.gained += 6.0
        elif state == "stuck":
            self.failure = "door gives up"
        elif self.time > 60.0:
            self.failure = "barn stays open"
        if self.failure:
            self.gained -= 6.0


@pytest.mark.tarl(
    nodes=["barn_door.py"],
    sensors=[
        Sensor("position", topic="door/position", field="data", low=0.0, high=3.2, bins=6, unit="m"),
        Sensor("current", topic="door/current", field="data", low=0.0, high=10.0, bins=8, unit="A"),
    ],
    drifts={"muddy": MUDDY},
    episodes=200,
    min_success=0.97,
)
def test_closes(tarl, tarl_drift):
    """Close the door: 6, a small cost per second, -6 for a squeezed animal."""
    barn = Barn(tarl.rng("barn"), **(tarl_drift or CLEAN))
    tarl.start("barn_door.py")
    while not barn.done:
        barn.publish(tarl.bus)
        tarl.step(DT)
        state = tarl.bus.latest("door/state")
        barn.advance(tarl.bus.latest("door/speed"), state.data if state else "")
        tarl.reward(barn.gained)
    assert not barn.failure, barn.failure
