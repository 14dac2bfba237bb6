"""A gantry stacks packs of bricks. Frosty bricks slide between its jaws; jaws that press harder soon crack them.

A pack on the pallet earns, seconds cost a little, and a pack that falls or cracks ends the shift.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")
Point = message_type("geometry_msgs/Point")

DT = 0.1
DRY = {"friction": 0.62}
FROSTY = {"friction": 0.35}
PACKS = 2


class Gantry:
    """A gantry whose packs have some `friction` against the jaws."""

    def __init__(self, rng, friction):
        self.rng = rng
        self.friction = friction * rng.normal(1.0, 0.015)
        self.mass = float(rng.uniform(60.5, 63.0))
        self.strength = float(rng.uniform(1060.0, 1100.0))  # N
        self.x, self.z = 0.0, 0.0
        self.vx, self.vz = 0.0, 0.0
        self.force = 0.0
        self.slipped = 0.0  # m
        self.placed = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the shift is over."""
        return bool(self.failure) or self.placed >= PACKS

    def publish(self, bus):
        """Publish gantry, jaws and belt."""
        noise = self.rng.normal(0.0, 0.001, 2)
        bus.publish("gantry/position", Point(x=self.x + noise[0], y=0.0, z=self.z + noise[1]))
        bus.publish("jaws/measured", Float32(data=max(0.0, self.force + self.rng.normal(0.0, 3.0))))
        if round(self.time / DT) % 5 == 0:
            bus.publish("belt/packs", Int32(data=PACKS - self.placed))

    def hold(self, vx, vz):
        """Let the pack slide between the jaws if it is heavier than their friction."""
        up = 9.81 + (self.vz - vz) / DT
        along = (self.vx - vx) / DT
        load = self.mass * (max(0.0, up) ** 2 + (0.4 * along) ** 2) ** 0.5
        excess = load / self.mass - 2.0 * self.friction * self.force / self.mass
        if excess > 0.0:
            self.slipped += 0.5 * excess * DT
        if self.slipped > 0.05:
            self.failure = "pack falls"

    def advance(self, speed, force, placed):
        """Work for one step."""
        self.time += DT
        self.gained = -0.002
        vx, vz = self.vx, self.vz
        self.vx += 0.64 * ((speed.x if speed else 0.0) - self.vx)
        self.vz += 0.64 * ((speed.z if speed else 0.0) - self.vz)
        self.x += DT * self.vx
        self.z = max(0.0, self.z + DT * self.vz)
        self.force += 0.28 * ((force.data if force else 0.0) - self.force)
        if self.force > self.strength:
            self.failure = "bricks crack"
        floor = 0.24 * self.placed if self.x > 1.2 else 0.0
        if self.z <= floor + 0.02:
            self.slipped = 0.0
        elif self.force > 100.0:
            self.hold(vx, vz)
        if placed and placed.data > self.placed:
            self.placed = placed.data
            if abs(self.x - 2.4) > 0.06:
                self.failure = "pack is beside the pallet"
            self.gained += 4.2
        if self.time > 60.0:
            self.failure = "shift ends"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["brick_gripper.py"],
    sensors=[
        Sensor("height", topic="gantry/position", field="z", low=0.0, high=1.2, bins=6, unit="m"),
        Sensor("x", topic="gantry/position", field="x", low=0.0, high=2.4, bins=6, unit="m"),
        Sensor("force", topic="jaws/measured", field="data", low=0.0, high=1200.0, bins=6, unit="N"),
    ],
    drifts={"frosty": FROSTY},
    episodes=200,
    min_success=0.97,
)
def test_stacks(tarl, tarl_drift):
    """Stack two packs: 4.2 for each, a small cost per second, -4 for a broken one."""
    gantry = Gantry(tarl.rng("gantry"), **(tarl_drift or DRY))
    tarl.start("brick_gripper.py")
    bus = tarl.bus
    while not gantry.done:
        gantry.publish(bus)
        tarl.step(DT)
        gantry.advance(bus.latest("gantry/speed"), bus.latest("jaws/force"), bus.latest("stacker/placed"))
        tarl.reward(gantry.gained)
    assert not gantry.failure, gantry.failure
