"""A robot tosses bottles into a bin. Full bottles slow its arm down; only the force in the gripper tells."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
WrenchStamped = message_type("geometry_msgs/WrenchStamped")

DT = 0.1
ITEMS = 6
EMPTY, FULL = 0.08, 1.0  # kg
HEIGHT, REACH = 0.9, 0.85  # m
HALF = 0.46  # half of the bin's opening (m)


class Cell:
    """A belt, an arm and a bin; `mass` is that of the items, in kg."""

    def __init__(self, rng, mass):
        self.rng = rng
        self.masses = mass * (1.0 + 0.05 * rng.normal(size=ITEMS))
        self.bin = rng.uniform(1.75, 2.25)  # distance to its front edge (m)
        self.item, self.empty, self.thrown = 0, 0.3, None
        self.hits, self.gained, self.time = 0, 0.0, 0.0

    @property
    def done(self):
        """Return whether all items are thrown, or time is up."""
        return self.item >= ITEMS or self.time > 20.0

    def publish(self, bus):
        """Publish the range of the bin and the weight in the gripper."""
        bus.publish("bin/range", Float32(data=self.bin + self.rng.normal(0.0, 0.01)))
        held = 0.0 if self.empty > 0.0 else 9.81 * self.masses[self.item]
        seen = WrenchStamped()
        seen.wrench.force.z = -held + self.rng.normal(0.0, 0.04)
        bus.publish("gripper/wrench", seen)

    def advance(self, command):
        """Let a thrown item fly and land; take the next one."""
        self.time += DT
        self.empty = max(0.0, self.empty - DT)
        self.gained = -0.01
        if command is None or command is self.thrown:
            return
        self.thrown = command
        mass = self.masses[self.item]
        speed = (
            command.point.x * (1.0 - 0.42 * mass / (mass + 0.25)) * (1.0 + 0.012 * self.rng.normal()) / 0.935
        )
        across, up = speed * math.cos(command.point.y), speed * math.sin(command.point.y)
        flight = (up + math.sqrt(up * up + 2 * 9.81 * HEIGHT)) / 9.81
        landed = REACH * math.cos(command.point.y) + across * flight
        off = abs(landed - self.bin - 0.30)
        self.hits += off < HALF
        self.gained += 1.7 - 0.4 * off if off < HALF else -1.0
        self.item += 1
        self.empty = 0.4


@pytest.mark.tarl(
    nodes=["waste_tosser.py", "ballistics.py"],
    sensors=[
        Sensor("bin", topic="bin/range", field="data", low=1.7, high=2.3, bins=3, unit="m"),
        Sensor(
            "force", topic="gripper/wrench", field="wrench.force.z", low=-12.0, high=0.0, bins=6, unit="N"
        ),
    ],
    drifts={"full bottles": FULL},
    episodes=200,
    min_success=0.97,
)
def test_tosses(tarl, tarl_drift):
    """Toss six bottles."""
    cell = Cell(tarl.rng("cell"), tarl_drift or EMPTY)
    tarl.start("waste_tosser.py")
    while not cell.done:
        cell.publish(tarl.bus)
        tarl.step(DT)
        cell.advance(tarl.bus.latest("arm/throw"))
        tarl.reward(cell.gained)
    assert cell.hits >= ITEMS - 1, f"{cell.hits} of {ITEMS} bottles in the bin"
