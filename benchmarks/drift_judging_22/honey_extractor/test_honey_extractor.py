"""An extractor spins honey out of combs. On hot days the wax is softer and the honey thinner, more or less so."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Temperature = message_type("sensor_msgs/msg/Temperature")

DT = 0.5
MILD = {"warmth": 25.0}
HOT = {"warmth": Drift.range(33.0, 37.0)}  # degrees


class Drum:
    """A load of combs at `warmth`, in degrees."""

    def __init__(self, rng, warmth):
        self.rng = rng
        self.warmth = warmth
        self.breaks = (335.0 - 11.0 * max(0.0, warmth - 25.0)) * rng.normal(1.0, 0.015)  # rpm
        self.thin = 0.13 * (1.0 + 0.14 * (warmth - 25.0)) * rng.uniform(0.95, 1.05)  # 1/s at 280 rpm
        self.whole = float(rng.uniform(2.6, 3.2))  # kg
        self.honey, self.rpm, self.flow = self.whole, 0.0, 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the load is out."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the flow, every two seconds the temperature, and once the lid."""
        if round(self.time / DT) % 4 == 0:
            bus.publish("comb/temperature", Temperature(temperature=self.warmth + self.rng.normal(0.0, 0.3)))
        if round(self.time / DT) == 2:
            bus.publish("lid/closed", Bool(data=True))
        bus.publish("outlet/flow", Float32(data=max(0.0, self.flow + self.rng.normal(0.0, 0.002))))

    def advance(self, motor, state):
        """Spin for one step."""
        self.time += DT
        self.gained = -0.004
        self.rpm += 0.5 * ((motor.data if motor else 0.0) - self.rpm)
        self.flow = self.thin * (self.rpm / 280.0) ** 2 * self.honey
        self.honey -= DT * self.flow
        if self.rpm > self.breaks:
            self.failure = "combs break"
        elif self.time > 45.0:
            self.failure = "load takes too long"
        elif state and state.data == "empty":
            self.over = True
            left = self.honey / self.whole
            self.gained += 8.0 - 30.0 * max(0.0, left - 0.09)
            if left > 0.2:
                self.failure = "honey stays in the combs"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["honey_extractor.py", "spin_profile.py"],
    sensors=[
        Sensor(
            "warmth", topic="comb/temperature", field="temperature", low=15.0, high=40.0, bins=10, unit="C"
        ),
        Sensor("flow", topic="outlet/flow", field="data", low=0.0, high=0.5, bins=5, unit="kg/s"),
    ],
    drifts={"hot": HOT},
    episodes=200,
    min_success=0.97,
)
def test_extracts(tarl, tarl_drift):
    """Spin one load."""
    drum = Drum(tarl.rng("drum"), **(tarl_drift or MILD))
    tarl.start("honey_extractor.py")
    while not drum.done:
        drum.publish(tarl.bus)
        tarl.step(DT)
        drum.advance(tarl.bus.latest("basket/rpm"), tarl.bus.latest("extractor/state"))
        tarl.reward(drum.gained)
    assert not drum.failure, drum.failure
