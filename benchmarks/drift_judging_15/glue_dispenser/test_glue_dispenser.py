"""A robot seals a door. The stator of its pump is worn, and a turn delivers less."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Vector3 = message_type("geometry_msgs/msg/Vector3")

DT = 0.05
AREA = 12.0  # cross-section of a good bead (mm²)
SEAM = 2.4  # m
PIECE = 0.2  # length of bead that is judged at once (m)
NEW, WORN = 0.60, 0.43  # ml per turn


class Seam:
    """A seam on a door; `turn` is what a turn of the pump delivers, in ml."""

    def __init__(self, rng, turn):
        self.rng = rng
        self.turn = turn * (1.0 + 0.02 * rng.normal())
        self.fast, self.slow = rng.uniform(0.26, 0.34), rng.uniform(0.12, 0.18)
        self.corner = rng.uniform(0.8, 1.5)
        self.warm = rng.uniform(21.0, 29.0)
        self.place, self.speed, self.laid, self.begun = 0.0, 0.0, 0.0, 0.0
        self.bad, self.gained = 0, 0.0

    @property
    def done(self):
        """Return whether the tool is at the end of the seam."""
        return self.place >= SEAM

    def publish(self, bus):
        """Publish the speed of the tool and the temperature of the barrel."""
        near = abs(self.place - self.corner) < 0.2
        wanted = self.slow if near else self.fast
        self.speed += max(-1.0 * DT, min(1.0 * DT, wanted - self.speed))
        bus.publish("tool/on_path", Bool(data=True))
        bus.publish("tool/velocity", Vector3(x=self.speed + self.rng.normal(0.0, 0.002), y=0.0, z=0.0))
        bus.publish("barrel/temperature", Float64(data=self.warm + self.rng.normal(0.0, 0.2)))

    def advance(self, command):
        """Move the tool and lay the bead; judge each piece of it when it is complete."""
        rpm = command.data if command else 0.0
        self.laid += rpm / 60.0 * self.turn / (1.0 + 0.004 * (self.warm - 25.0)) * DT
        self.place += self.speed * DT
        self.gained = -0.02
        if self.place - self.begun >= PIECE:
            share = self.laid / (AREA * (self.place - self.begun))
            self.gained += 1.0 - min(2.0, 30.0 * max(0.0, abs(share - 1.0) - 0.06) ** 1.0)
            self.bad += abs(share - 1.0) > 0.18 and self.begun > 0.0
            self.begun, self.laid = self.place, 0.0


@pytest.mark.tarl(
    nodes=["glue_dispenser.py", "pump.py"],
    sensors=[
        Sensor("speed", topic="tool/velocity", field="x", low=0.0, high=0.4, bins=4, unit="m/s"),
        Sensor("temperature", topic="barrel/temperature", field="data", low=18.0, high=34.0, bins=4),
    ],
    drifts={"worn stator": Drift(WORN, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_seals(tarl, tarl_drift):
    """Seal one door."""
    seam = Seam(tarl.rng("seam"), tarl_drift or NEW)
    tarl.start("glue_dispenser.py")
    while not seam.done:
        seam.publish(tarl.bus)
        tarl.step(DT)
        seam.advance(tarl.bus.latest("pump/rpm"))
        tarl.reward(seam.gained)
    assert seam.bad <= 1, f"{seam.bad} pieces of the bead are too thin or too thick"
