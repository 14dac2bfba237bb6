"""A drum roaster roasts a batch of coffee. Beans of the monsoon are moister, and drying them takes more heat."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 1.0
USUAL = 10.5  # % of water


class Drum:
    """A drum with green beans that hold `moisture` percent of water."""

    def __init__(self, rng, moisture):
        self.rng = rng
        self.moisture = moisture + rng.uniform(-0.4, 0.4)
        self.mass = rng.normal(1.0, 0.015)
        self.bean = 95.0 + rng.normal(0.0, 1.5)
        self.burner = 0.2
        self.time, self.dried, self.cracked = 0.0, None, None
        self.gained, self.failure, self.over = 0.0, "", False

    @property
    def done(self):
        """Return whether the beans are dropped, or the batch is lost."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the probe, and now and then the moisture meter."""
        bus.publish("bean/temperature", Float32(data=self.bean + self.rng.normal(0.0, 0.15)))
        if round(self.time) % 10 == 0:
            bus.publish("green/moisture", Float32(data=self.moisture + self.rng.normal(0.0, 0.1)))
        bus.publish("drum/charged", Bool(data=self.time >= 3.0))

    def advance(self, burner, fan, door):
        """Heat for one second; until 150 degrees, the heat goes into water as well."""
        self.burner += 0.25 * ((burner.data if burner else 0.0) - self.burner)
        blow = fan.data if fan else 0.3
        capacity = self.mass * (1.0 + (0.095 * (self.moisture - USUAL) if self.bean < 150.0 else 0.0))
        heat = (
            1.0 * self.burner - 0.0011 * (1.0 + blow) * (self.bean - 25.0) + (0.04 if self.cracked else 0.0)
        )
        self.bean += DT * heat / capacity
        self.time += DT
        self.gained = -0.002
        if self.dried is None and self.bean >= 150.0:
            self.dried = self.time
            self.gained += 4.0 * max(-1.0, 1.0 - ((self.dried - 158.0) / 45.0) ** 2)
            if self.dried < 125.0:
                self.failure = "tips of the beans are scorched"
        elif self.cracked is None and self.bean >= 196.0:
            self.cracked = self.time
        elif self.dried is None and self.time > 192.0:
            self.failure = "beans are baked, not roasted"
        elif self.bean > 222.0:
            self.failure = "beans burn"
        elif self.time > 700.0:
            self.failure = "batch takes too long"
        elif door and door.data:
            self.over = True
            developed = self.time - self.cracked if self.cracked else 0.0
            self.gained += 2.0 * max(-1.0, 1.0 - ((developed - 68.0) / 50.0) ** 2)
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["coffee_roaster.py"],
    sensors=[
        Sensor("moisture", topic="green/moisture", field="data", low=8.0, high=18.0, bins=5, unit="%"),
        Sensor("bean", topic="bean/temperature", field="data", low=90.0, high=220.0, bins=5, unit="°C"),
    ],
    drifts={"monsoon": Drift.range(13.6, 14.8)},
    episodes=200,
    min_success=0.97,
)
def test_roasts(tarl, tarl_drift):
    """Roast one batch."""
    drum = Drum(tarl.rng("drum"), tarl_drift or USUAL)
    tarl.start("coffee_roaster.py")
    while not drum.done:
        drum.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        drum.advance(bus.latest("burner/power"), bus.latest("fan/speed"), bus.latest("door/open"))
        tarl.reward(drum.gained)
    assert not drum.failure, drum.failure
