"""A feeder doses a meal for a cage of fish. In a damp silo, pellets stick together and the auger delivers less."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
RelativeHumidity = message_type("sensor_msgs/RelativeHumidity")

DT = 0.5
DRY = {"flow": 0.085, "humidity": 0.45}
DAMP = {"flow": 0.06, "humidity": 0.82}


class Cage:
    """A cage whose auger delivers `flow`, in kg/s."""

    def __init__(self, rng, flow, humidity):
        self.rng = rng
        self.flow = flow * rng.normal(1.0, 0.01)
        self.humidity = humidity
        self.order = float(rng.uniform(1.2, 2.0))
        self.auger, self.air, self.fed, self.clog = 0.0, 0.0, 0.0, 0.0
        self.begun = False
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the meal is over."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the order once, and the humidity every second."""
        if round(self.time / DT) % 2 == 0:
            wet = self.humidity + self.rng.normal(0.0, 0.015)
            bus.publish("silo/humidity", RelativeHumidity(relative_humidity=wet))
        if round(self.time / DT) == 2:
            bus.publish("cage/order", Float32(data=self.order))

    def advance(self, auger, blower, phase):
        """Feed for one step."""
        self.time += DT
        self.gained = -0.002
        self.auger += 0.8 * ((auger.data if auger else 0.0) - self.auger)
        self.air += 0.5 * ((blower.data if blower else 0.0) - self.air)
        flow = DT * self.flow * self.auger * self.rng.normal(1.0, 0.05)
        self.fed += flow
        self.clog = max(0.0, self.clog + flow - 0.3 * self.air)
        self.begun = self.begun or self.fed > 0.1
        if self.clog > 0.3:
            self.failure = "pipe is blocked"
        elif self.time > 60.0:
            self.failure = "meal takes too long"
        elif self.begun and phase and phase.data == "idle":
            self.over = True
            off = self.fed / self.order - 1.0
            self.gained += 8.0 - 40.0 * max(0.0, abs(off) - 0.06)
            if off < -0.15:
                self.failure = "fish stay hungry"
            elif off > 0.15:
                self.failure = "pellets rot below the cage"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["fish_feeder.py"],
    sensors=[
        Sensor("humidity", topic="silo/humidity", field="relative_humidity", low=0.0, high=1.0, bins=10),
        Sensor("order", topic="cage/order", field="data", low=0.0, high=4.0, bins=8, unit="kg"),
    ],
    drifts={"damp": DAMP},
    episodes=200,
    min_success=0.97,
)
def test_feeds(tarl, tarl_drift):
    """Dose one meal."""
    cage = Cage(tarl.rng("cage"), **(tarl_drift or DRY))
    tarl.start("fish_feeder.py")
    while not cage.done:
        cage.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        cage.advance(bus.latest("auger"), bus.latest("blower"), bus.latest("feeder/phase"))
        tarl.reward(cage.gained)
    assert not cage.failure, cage.failure
