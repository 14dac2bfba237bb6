"""A robot brews black tea. On a mountain water boils at 87 °C, and the tea is weak."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
FluidPressure = message_type("sensor_msgs/msg/FluidPressure")
String = message_type("std_msgs/msg/String")
Temperature = message_type("sensor_msgs/msg/Temperature")

DT = 2.0
TIME_BOUND = 390.0
WEAK, STRONG = 0.84, 1.18


class Pot:
    """Water, a basket of tea, and the air above."""

    def __init__(self, rng, altitude):
        self.rng = rng
        self.pressure = 1013.0 * math.exp(-altitude / 8000.0) + rng.normal(0.0, 5.0)
        self.boils = 100.0 - 0.0365 * (1013.0 - self.pressure)
        self.water = rng.uniform(55.0, 65.0)
        self.leaf = rng.normal(1.0, 0.03)
        self.strength, self.depth = 0.0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.was_in, self.done = False, False
        self.failure = ""

    def publish(self, bus):
        """Publish the order and the measurements."""
        if self.time == 0.0:
            bus.publish("order", String(data="black"))
        bus.publish("kettle/temperature", Temperature(temperature=self.water + self.rng.normal(0.0, 0.1)))
        air = self.pressure + self.rng.normal(0.0, 1.0)
        bus.publish("air/pressure", FluidPressure(fluid_pressure=100.0 * air))

    def advance(self, power, depth):
        """Heat and steep for one step."""
        heat = min(max(power.data, 0.0), 1.0) if power else 0.0
        self.water += (0.9 * heat - 0.0012 * (self.water - 20.0)) * DT
        self.water = min(self.water, self.boils)
        self.depth += 0.6 * ((depth.data if depth else 0.0) - self.depth)
        self.gained = 0.0
        if self.depth > 0.06:
            self.was_in = True
            pace = math.exp((self.water - 97.0) / 17.0) * self.leaf * self.rng.normal(1.0, 0.1)
            before = self.strength
            self.strength += pace * DT / 150.0
            self.gained = min(self.strength, 1.0) - min(before, 1.0)
        elif self.was_in:
            self.done = True
        self.time += DT

    def judge(self):
        """Return the reward of the step: strength gained; tea that is too weak or too strong is poured away."""
        if self.done and self.strength < WEAK:
            self.failure = "weak"
        elif self.strength > STRONG:
            self.failure = "bitter"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        if self.failure:
            self.done = True
        return 10.0 * self.gained - 0.001 - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["tea_brewer.py"],
    sensors=[
        Sensor(
            "pressure",
            topic="air/pressure",
            field="fluid_pressure",
            low=55000,
            high=105000,
            bins=10,
            unit="Pa",
        ),
        Sensor("water", topic="kettle/temperature", field="temperature", low=20, high=100, bins=4, unit="°C"),
    ],
    drifts={"mountain": 3500.0},
    episodes=200,
    min_success=0.97,
)
def test_brews(tarl, tarl_drift):
    """Brew one pot."""
    pot = Pot(tarl.rng("pot"), tarl_drift or 0.0)
    tarl.start("tea_brewer.py")
    while not pot.done:
        pot.publish(tarl.bus)
        tarl.step(DT)
        pot.advance(tarl.bus.latest("kettle/power"), tarl.bus.latest("basket/depth"))
        tarl.reward(pot.judge())
    assert not pot.failure, pot.failure
