"""A hot-air balloon follows altitudes of a plan. Its burner is replaced by a double one, for good."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.5
SINGLE = {"power": 0.62}
DOUBLE = {"power": 1.7}  # K per s in the envelope


class Sky:
    """A balloon whose burner heats the envelope by `power`, in K/s."""

    def __init__(self, rng, power):
        self.rng = rng
        self.power = power * rng.normal(1.0, 0.03)
        self.load = rng.normal(1.0, 0.01)
        self.altitude, self.climb = 80.0 + float(rng.uniform(-5.0, 5.0)), 0.0
        self.level = 60.0 * self.load  # K that carry the load
        self.heat = self.level + rng.normal(0.0, 0.3)
        self.plan = [80.0, 80.0 + float(rng.uniform(16.0, 24.0)), 82.0 + float(rng.uniform(-5.0, 5.0))]
        self.gust, self.fuel = 0.0, 24.0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the flight is over."""
        return bool(self.failure) or self.time >= 240.0

    def wanted(self):
        """Return the altitude of the plan."""
        return self.plan[min(2, int(self.time // 80.0))]

    def publish(self, bus):
        """Publish the instruments, and every five seconds the plan and the gauge."""
        bus.publish("altimeter", Float32(data=self.altitude + self.rng.normal(0.0, 0.4)))
        bus.publish("vario", Float32(data=self.climb + self.rng.normal(0.0, 0.08)))
        if round(self.time / DT) % 10 == 0:
            bus.publish("fuel", Float32(data=self.fuel))
            bus.publish("plan/altitude", Float32(data=self.wanted()))

    def advance(self, burner, vent):
        """Fly for one step."""
        self.time += DT
        self.gained = 0.0
        self.heat -= DT * (self.heat - 10.0) / 420.0
        if burner and burner.data:
            self.heat += DT * self.power
            self.fuel -= DT * 0.09 * self.power / 0.62
        if vent and vent.data:
            self.heat -= DT * 0.8
        self.gust += -0.05 * self.gust + self.rng.normal(0.0, 0.01)
        lift = 0.1 * (self.heat - self.level)
        drag = self.climb * (0.22 + 0.08 * abs(self.climb))
        self.climb += DT * (lift - drag + 0.2 * self.gust)
        self.altitude += DT * self.climb
        off = abs(self.altitude - self.wanted())
        if self.time % 80.0 > 40.0:
            self.gained = 0.05 - 0.01 * max(0.0, off - 4.0)
            if off > 15.0:
                self.failure = "balloon leaves its layer"
        if self.altitude < 45.0:
            self.failure = "basket touches the trees"
        elif self.fuel < 3.0:
            self.failure = "fuel is out"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["balloon_pilot.py"],
    sensors=[
        Sensor("altitude", topic="altimeter", field="data", low=40.0, high=140.0, bins=10, unit="m"),
        Sensor("climb", topic="vario", field="data", low=-4.0, high=4.0, bins=8, unit="m/s"),
    ],
    drifts={"double": Drift(DOUBLE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_flies(tarl, tarl_drift):
    """Fly one plan."""
    sky = Sky(tarl.rng("sky"), **(tarl_drift or SINGLE))
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("balloon_pilot.py", parameters=config["balloon_pilot"]["ros__parameters"])
    while not sky.done:
        sky.publish(tarl.bus)
        tarl.step(DT)
        sky.advance(tarl.bus.latest("burner/open"), tarl.bus.latest("vent/open"))
        tarl.reward(sky.gained)
    assert not sky.failure, sky.failure
