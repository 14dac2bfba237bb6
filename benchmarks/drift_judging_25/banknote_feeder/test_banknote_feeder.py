"""A machine counts bundles of banknotes. New notes of polymer are thinner; now and then two of them stick together.

A right count earns, seconds and diverted single notes cost a little, and a wrong count is a large loss.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Vector3 = message_type("geometry_msgs/msg/Vector3")

DT = 0.2
PAPER = {"thickness": 0.112}
POLYMER = {"thickness": 0.086}  # mm


class Bank:
    """A bundle of notes with some `thickness`."""

    def __init__(self, rng, thickness):
        self.rng = rng
        self.thickness = thickness * rng.normal(1.0, 0.01)
        self.hopper = int(rng.integers(60, 90))
        self.notes = self.hopper
        self.path = 0  # notes between the feeder and the diverter
        self.diverted, self.refed = 0, 0
        self.flips, self.counts, self.alarms = 0, [], 0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the bundle is counted."""
        return bool(self.failure) or self.over

    def publish(self, bus, run):
        """Publish the hopper, and a note that the feeder draws."""
        if self.time > 0.5 and run and self.hopper:
            drawn = 2 if self.hopper > 1 and self.rng.random() < 0.0019 else 1
            self.hopper -= drawn
            self.path = drawn
            thick = sum(self.thickness * self.rng.normal(1.0, 0.03) for _ in range(drawn))
            skew = self.rng.normal(0.0, 0.03)
            length = 140.0 + self.rng.normal(0.0, 0.8)
            bus.publish("gauge/note", Vector3(x=float(thick), y=float(length), z=float(skew)))
        bus.publish("hopper/full", Bool(data=self.hopper > 0))

    def advance(self):
        """Let one step pass; the operator puts diverted notes back into the hopper."""
        self.time += DT
        self.gained = -0.001
        if self.flips and self.path:
            self.gained -= 0.02
            self.diverted += 1
            self.hopper += self.path
        self.flips, self.path = 0, 0
        for count in self.counts:
            self.over = True
            self.gained += 6.0
            if count != self.notes:
                self.failure = "count is wrong"
        self.counts.clear()
        if self.alarms:
            self.failure = "feeder stops"
        elif self.time > 60.0:
            self.failure = "counter closes"
        if self.failure:
            self.gained -= 11.0


@pytest.mark.tarl(
    nodes=["banknote_feeder.py"],
    sensors=[
        Sensor("thickness", topic="gauge/note", field="x", low=0.0, high=0.3, bins=10, unit="mm"),
        Sensor("skew", topic="gauge/note", field="z", low=-0.2, high=0.2, bins=4, unit="rad"),
    ],
    drifts={"polymer": POLYMER},
    episodes=200,
    min_success=0.97,
)
def test_counts(tarl, tarl_drift):
    """Count one bundle: 6 for a right count, small costs per second and per diverted note, -5 for a wrong count."""
    bank = Bank(tarl.rng("bank"), **(tarl_drift or PAPER))
    tarl.start("banknote_feeder.py")
    bus = tarl.bus
    bus.subscribe("diverter/flip", lambda _: setattr(bank, "flips", bank.flips + 1))
    bus.subscribe("bundle/count", lambda message: bank.counts.append(message.data))
    bus.subscribe("feeder/alarm", lambda _: setattr(bank, "alarms", bank.alarms + 1))
    while not bank.done:
        run = bus.latest("feeder/run")
        bank.publish(bus, run is not None and run.data)
        tarl.step(DT)
        bank.advance()
        tarl.reward(bank.gained)
    assert not bank.failure, bank.failure
