"""A turbine feeds a valley. In the dry season it takes its water from a lake far above, through a long penstock."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.2
BROOK = {"inertia": 0.25}
LAKE = {"inertia": 1.5}  # s


class Plant:
    """A plant whose water has some `inertia`: the time in s that it takes to start in the open penstock."""

    def __init__(self, rng, inertia):
        self.rng = rng
        self.inertia = inertia * rng.normal(1.0, 0.04)
        self.mass = 10.0 * rng.normal(1.0, 0.05)  # s from standstill to 50 Hz at full power
        self.gate, self.head, self.frequency = 0.0, 1.0, 0.0
        self.load = 0.0
        self.wanted = float(rng.uniform(0.5, 0.7))
        self.trips = float(rng.uniform(62.0, 70.0))
        self.closed, self.steady, self.tripped = False, 0.0, False
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the time is over."""
        return bool(self.failure) or self.time >= 90.0

    def publish(self, bus):
        """Publish the generator, the penstock, the breaker, and every two seconds the permit."""
        if round(self.time / DT) % 10 == 0:
            bus.publish("plant/permit", Bool(data=True))
        bus.publish("generator/frequency", Float32(data=self.frequency + self.rng.normal(0.0, 0.02)))
        bus.publish("penstock/head", Float32(data=self.head + self.rng.normal(0.0, 0.01)))
        bus.publish("breaker/closed", Bool(data=self.closed))

    def switch(self):
        """Close the breaker at a steady frequency, change the load, and trip once."""
        off = abs(self.frequency - 50.0)
        self.steady = self.steady + DT if off < 0.8 else 0.0
        if not self.closed and not self.tripped and self.steady > 1.0:
            self.closed = True
        if self.closed:
            self.load += DT * 0.05 * (self.wanted - self.load) + self.rng.normal(0.0, 0.004)
            self.load = max(0.0, self.load)
            if self.time > self.trips:
                self.closed, self.tripped = False, True
        if not self.closed:
            self.load = 0.0

    def advance(self, opening):
        """Turn for one step."""
        self.time += DT
        self.switch()
        wanted = opening.data if opening else 0.0
        for _ in range(4):
            speed = (wanted - self.gate) / 0.5  # of the servo of the gate
            self.gate += 0.25 * DT * speed
            self.head += 0.5 * (1.0 - self.inertia * speed - self.head)
            power = self.gate * max(0.0, self.head) ** 1.5
            friction = 0.05 * (self.frequency / 50.0) ** 2
            self.frequency += 0.25 * DT * 50.0 / self.mass * (power - friction - self.load)
            self.frequency = max(0.0, self.frequency)
            if self.head > 1.6:
                self.failure = "penstock bursts"
            elif self.head < 0.4:
                self.failure = "penstock collapses"
        off = abs(self.frequency - 50.0)
        self.gained = 0.025 - 0.0015 * min(10.0, off) if self.time > 24.0 else 0.0
        if self.closed and off > 6.0:
            self.failure = "valley is dark"
        elif self.time > 45.0 and not self.closed and not self.tripped:
            self.failure = "generator does not start"
        elif self.frequency > 64.0:
            self.failure = "turbine runs away"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["turbine_gate.py"],
    sensors=[
        Sensor(
            "frequency", topic="generator/frequency", field="data", low=0.0, high=65.0, bins=13, unit="Hz"
        ),
        Sensor("head", topic="penstock/head", field="data", low=0.0, high=2.0, bins=10),
    ],
    drifts={"lake": LAKE},
    episodes=200,
    min_success=0.97,
)
def test_feeds(tarl, tarl_drift):
    """Feed the valley for a minute and a half, with a trip."""
    plant = Plant(tarl.rng("plant"), **(tarl_drift or BROOK))
    tarl.start("turbine_gate.py")
    while not plant.done:
        plant.publish(tarl.bus)
        tarl.step(DT)
        plant.advance(tarl.bus.latest("gate/opening"))
        tarl.reward(plant.gained)
    assert not plant.failure, plant.failure
