"""A clinic sterilises instruments. It moves to places of 1,900 to 2,500 m, where the air is thinner."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
FluidPressure = message_type("sensor_msgs/msg/FluidPressure")

DT = 2.0
COAST = {"altitude": 60.0}
PLATEAU = {"altitude": Drift.range(1900.0, 2500.0)}  # m


def boiling(bar):
    """Return the temperature of saturated steam."""
    return 1810.94 / (8.14019 - math.log10(bar * 750.062)) - 244.485


class Chamber:
    """A chamber at an `altitude`, in m."""

    def __init__(self, rng, altitude):
        self.rng = rng
        self.outside = 1.013 * (1.0 - 2.2558e-5 * altitude) ** 5.2559 + rng.normal(0.0, 0.004)  # bar
        self.power = 0.034 * rng.normal(1.0, 0.05)  # bar per s
        self.loss = 0.004 * rng.normal(1.0, 0.1)
        self.offset = rng.normal(0.0, 0.005)
        self.air = float(rng.uniform(0.25, 0.35))  # share of the chamber
        self.pressure = self.outside
        self.dose = 0.0  # minutes at 134 degrees
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the load is out."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the gauge, once the lock of the door, and every ten seconds the barometer of the clinic."""
        if round(self.time / DT) % 5 == 0:
            outside = self.outside + self.rng.normal(0.0, 0.002)
            bus.publish("clinic/barometer", FluidPressure(fluid_pressure=1e5 * outside))
        if round(self.time / DT) == 2:
            bus.publish("door/locked", Bool(data=True))
        gauge = self.pressure - self.outside + self.offset + self.rng.normal(0.0, 0.004)
        bus.publish("chamber/gauge", FluidPressure(fluid_pressure=1e5 * gauge))

    def advance(self, duty, valve, phase):
        """Heat for one step."""
        self.time += DT
        self.gained = -0.005
        over = self.pressure - self.outside
        self.pressure += DT * (self.power * (duty.data if duty else 0.0) - self.loss * over)
        if valve and valve.data:
            self.pressure -= DT * 0.08 * over
            self.air *= 1.0 - DT * 0.04
        if phase and phase.data in ("heat", "hold"):
            inside = boiling(self.pressure) - 20.0 * max(0.0, self.air - 0.03)  # air is heavier than steam
            self.dose += DT / 60.0 * 10.0 ** ((inside - 134.0) / 10.0)
        if self.pressure - self.outside > 2.6:
            self.failure = "safety valve opens"
        elif self.time > 900.0:
            self.failure = "load takes too long"
        elif phase and phase.data == "done":
            self.over = True
            self.gained += 8.0 - 2.0 * max(0.0, 4.0 - self.dose) - 1.0 * max(0.0, self.dose - 5.4)
            if self.dose < 3.0:
                self.failure = "indicator strip stays pale"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["autoclave.py", "steam.py"],
    sensors=[
        Sensor(
            "barometer",
            topic="clinic/barometer",
            field="fluid_pressure",
            low=70000.0,
            high=105000.0,
            bins=7,
            unit="Pa",
        ),
        Sensor(
            "gauge", topic="chamber/gauge", field="fluid_pressure", low=0.0, high=250000.0, bins=10, unit="Pa"
        ),
    ],
    drifts={"plateau": PLATEAU},
    episodes=200,
    min_success=0.97,
)
def test_sterilises(tarl, tarl_drift):
    """Sterilise one load."""
    chamber = Chamber(tarl.rng("chamber"), **(tarl_drift or COAST))
    tarl.start("autoclave.py")
    while not chamber.done:
        chamber.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        chamber.advance(bus.latest("heater/duty"), bus.latest("valve/open"), bus.latest("autoclave/phase"))
        tarl.reward(chamber.gained)
    assert not chamber.failure, chamber.failure
