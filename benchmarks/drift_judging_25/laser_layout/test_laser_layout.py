"""A laser shows fitters where to drill. It gets a new bracket, for good, which holds it farther beside the pan axis.

Each hole earns if it is drilled in its place, less the further away; a hole far from its place is a failure.
"""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
JointState = message_type("sensor_msgs/JointState")
Point = message_type("geometry_msgs/Point")

DT = 0.1
SLIM = {"offset": 0.03}
WIDE = {"offset": 0.16}  # m


class Hall:
    """A hall with a laser at some `offset` beside its pan axis."""

    def __init__(self, rng, offset):
        self.rng = rng
        self.offset = offset + rng.normal(0.0, 0.001)
        self.height = 1.42 + rng.normal(0.0, 0.002)
        self.pan, self.tilt = float(rng.uniform(-0.5, 0.5)), 0.5
        self.rates = [0.0, 0.0]
        self.marks = []
        for _ in range(5):
            far, way = float(rng.uniform(1.2, 4.0)), float(rng.uniform(-1.8, 1.8))
            self.marks.append((far * math.cos(way), far * math.sin(way)))
        self.drilled, self.lit = 0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the holes are drilled."""
        return bool(self.failure) or self.drilled >= len(self.marks)

    def publish(self, bus):
        """Publish the head, the level every second, and once the marks."""
        step = round(self.time / DT)
        noise = self.rng.normal(0.0, 0.0003, 2)
        bus.publish(
            "head/joints",
            JointState(name=["pan", "tilt"], position=[self.pan + noise[0], self.tilt + noise[1]]),
        )
        if step % 10 == 0:
            bus.publish("tripod/level", Float32(data=float(self.rng.normal(0.0, 0.001))))
        if step == 5:
            for x, y in self.marks:
                bus.publish("plan/mark", Point(x=x, y=y, z=0.0))

    def spot(self):
        """Return where the beam meets the floor."""
        ahead = self.height / math.tan(max(0.05, self.tilt))
        return (
            ahead * math.cos(self.pan) - self.offset * math.sin(self.pan),
            ahead * math.sin(self.pan) + self.offset * math.cos(self.pan),
        )

    def advance(self, command, beam):
        """Drill for one step: a fitter marks a hole once the beam has been on for half a second."""
        self.time += DT
        self.gained = -0.002
        wanted = list(command.velocity) if command else [0.0, 0.0]
        self.rates = [have + 0.6 * (want - have) for have, want in zip(self.rates, wanted, strict=True)]
        self.pan += DT * self.rates[0]
        self.tilt += DT * self.rates[1]
        before = self.lit
        self.lit = self.lit + DT if beam and beam.data else 0.0
        if before < 0.95 <= self.lit:
            x, y = self.spot()
            off = math.hypot(x - self.marks[self.drilled][0], y - self.marks[self.drilled][1])
            self.gained += 2.0 - 20.0 * max(0.0, off - 0.02)
            self.drilled += 1
            if off > 0.06:
                self.failure = "hole is out of place"
        elif self.time > 60.0:
            self.failure = "fitters go home"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["laser_layout.py"],
    sensors=[
        Sensor("pan", topic="head/joints", field="position[0]", low=-2.6, high=2.6, bins=6, unit="rad"),
        Sensor("tilt", topic="head/joints", field="position[1]", low=0.0, high=1.5, bins=5, unit="rad"),
    ],
    drifts={"wide": Drift(WIDE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_marks(tarl, tarl_drift):
    """Show five marks: up to 2 for each hole, a small cost per second, -4 for a hole out of place."""
    hall = Hall(tarl.rng("hall"), **(tarl_drift or SLIM))
    tarl.start("laser_layout.py")
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("head/command"), tarl.bus.latest("laser/on"))
        tarl.reward(hall.gained)
    assert not hall.failure, hall.failure
