"""A snow gun covers a piste. When many guns share a compressor, its air splits the water into larger drops.

Each step earns for snow that is neither slush nor dust that blows away. Too much of either ends the night.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 2.0  # s
ALONE = {"pressure": 7.2}
SHARED = {"pressure": 5.0}  # bar


class Piste:
    """A piste whose gun gets air of some `pressure`."""

    def __init__(self, rng, pressure):
        self.rng = rng
        self.pressure = pressure + rng.normal(0.0, 0.08)
        self.temperature = float(rng.uniform(-8.0, -4.5))
        self.trend = float(rng.uniform(-0.004, 0.002))
        self.humidity = float(rng.uniform(55.0, 75.0))
        self.plume = 9.1 * rng.normal(1.0, 0.02)
        self.flow = 0.0
        self.slush, self.dust, self.idle = 0.0, 0.0, 0.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the night is over."""
        return bool(self.failure) or self.time >= 400.0

    def publish(self, bus):
        """Publish the permit, the weather every four seconds, and the air."""
        step = round(self.time / DT)
        if step % 20 == 1:
            bus.publish("resort/enable", Bool(data=True))
        if step % 2 == 0:
            bus.publish("mast/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 0.08)))
            bus.publish("mast/humidity", Float32(data=self.humidity + self.rng.normal(0.0, 0.8)))
        bus.publish("compressor/pressure", Float32(data=self.pressure + self.rng.normal(0.0, 0.06)))

    def frozen(self):
        """Return how much of the water the air could freeze before the drops land, as a part of the flow."""
        cold = -(self.temperature - 0.045 * (100.0 - self.humidity))  # of the wet bulb, at these temperatures
        drop = (7.2 / self.pressure) ** 0.9 * (0.5 + 0.5 * (self.flow / 50.0) ** 0.2)
        return self.plume * cold / (self.flow * drop**2)

    def advance(self, water, fan):
        """Snow for one step."""
        self.time += DT
        self.temperature += self.trend * DT + self.rng.normal(0.0, 0.01)
        self.flow += 0.5 * ((water.data if water else 0.0) - self.flow)
        self.gained = 0.0
        if self.time < 40.0:
            return
        if self.flow < 10.0 or not (fan and fan.data):
            self.idle += DT
        else:
            frozen = self.frozen()
            self.gained = 0.05 - 0.25 * max(0.0, abs(frozen - 1.02) - 0.22)
            self.slush += DT * max(0.0, 0.72 - frozen)
            self.dust += DT * max(0.0, frozen - 1.45)
        if self.slush > 6.0:
            self.failure = "piste is slush"
        elif self.dust > 25.0:
            self.failure = "snow blows away"
        elif self.idle > 60.0:
            self.failure = "piste stays green"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["snow_gun.py"],
    sensors=[
        Sensor("temperature", topic="mast/temperature", field="data", low=-12.0, high=0.0, bins=6, unit="C"),
        Sensor("pressure", topic="compressor/pressure", field="data", low=0.0, high=9.0, bins=9, unit="bar"),
    ],
    drifts={"shared": SHARED},
    episodes=200,
    min_success=0.97,
)
def test_snows(tarl, tarl_drift):
    """Make snow for seven minutes: reward for each step with good snow, less the further from it, -4 for an end."""
    piste = Piste(tarl.rng("piste"), **(tarl_drift or ALONE))
    tarl.start("snow_gun.py")
    while not piste.done:
        piste.publish(tarl.bus)
        tarl.step(DT)
        piste.advance(tarl.bus.latest("gun/water"), tarl.bus.latest("gun/fan"))
        tarl.reward(piste.gained)
    assert not piste.failure, piste.failure
