"""A baler presses hay. In the evening the hay is damp, and slides worse along the walls of the channel."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.5
NOON = {"moisture": 0.14}
EVENING = {"moisture": 0.25}


class Field:
    """A field of hay with some `moisture`."""

    def __init__(self, rng, moisture):
        self.rng = rng
        self.moisture = moisture + rng.normal(0.0, 0.006)
        damp = (self.moisture - 0.14) / 0.11
        self.grip = (1.0 + 0.55 * damp) * rng.normal(1.0, 0.02)  # of the walls on the bale
        self.tough = 1.0 + 1.5 * damp  # of a flake against the plunger
        self.weight = 1.0 + 0.13 * damp
        self.height = 0.35
        self.pressure, self.speed, self.load = 0.0, 0.0, 0.0
        self.length, self.mass, self.bales, self.row = 0.0, 0.0, 0, 0.0
        self.broken = 1.0 + rng.normal(0.0, 0.01)
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the row is baled, or something broke."""
        return bool(self.failure) or self.row >= 110.0

    def publish(self, bus):
        """Publish the sensors of the baler."""
        if round(self.time / DT) % 4 == 0:
            bus.publish("pto/on", Bool(data=True))
            bus.publish("channel/moisture", Float32(data=self.moisture + self.rng.normal(0.0, 0.01)))
        bus.publish("swath/height", Float32(data=self.height + self.rng.normal(0.0, 0.02)))
        bus.publish("plunger/load", Float32(data=self.load + self.rng.normal(0.0, 0.01)))
        bus.publish("channel/star_wheel", Float32(data=self.length))
        bus.publish("knotter/count", Int32(data=self.bales))

    def advance(self, speed, pressure, knot):
        """Drive for one step."""
        self.time += DT
        self.gained = -0.006
        self.speed = speed.data if speed else 0.0
        self.pressure += 0.6 * ((pressure.data if pressure else 0.0) - self.pressure)
        self.row += DT * self.speed
        self.height += 0.2 * (0.35 - self.height) + self.rng.normal(0.0, 0.012)
        taken = 0.18 * max(0.05, self.height) * self.speed * DT  # m of a bale
        flake = taken / (1.5 * DT)
        press = self.pressure * self.grip
        self.load = 0.0062 * press + 3.6 * flake * self.tough + self.rng.normal(0.0, 0.012) if flake else 0.0
        self.length += taken
        self.mass += taken * 0.36 * 0.46 * 1.75 * press * self.weight
        if self.load > self.broken:
            self.failure = "bolt of the flywheel shears"
        if knot and knot.data and self.length >= 0.9:
            density = self.mass / (self.length * 0.36 * 0.46)
            if self.bales:  # the first bale is loose, since the channel was empty
                self.gained += 3.0 - 0.03 * max(0.0, abs(density - 160.0) - 14.0)
            self.bales += 1
            if self.mass > 34.0 and self.bales > 1:
                self.failure = "bale is too heavy"
            elif density < 115.0 and self.bales > 1:
                self.failure = "bale falls apart"
            self.length, self.mass = 0.0, 0.0
        if self.time > 160.0:
            self.failure = "dew falls before the row is baled"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["hay_baler.py", "crops.py"],
    sensors=[
        Sensor("moisture", topic="channel/moisture", field="data", low=0.05, high=0.35, bins=6),
        Sensor("load", topic="plunger/load", field="data", low=0.0, high=1.2, bins=6),
        Sensor("height", topic="swath/height", field="data", low=0.2, high=0.5, bins=4, unit="m"),
    ],
    drifts={"evening": EVENING},
    episodes=200,
    min_success=0.97,
)
def test_bales(tarl, tarl_drift):
    """Bale one row."""
    field = Field(tarl.rng("field"), **(tarl_drift or NOON))
    tarl.start("hay_baler.py")
    while not field.done:
        field.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        field.advance(bus.latest("tractor/speed"), bus.latest("channel/pressure"), bus.latest("knotter/trip"))
        tarl.reward(field.gained)
    assert not field.failure, field.failure
