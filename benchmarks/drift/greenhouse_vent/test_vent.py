"""The crop survives two hours around noon.

The crop is judged at the end; a scorched or chilled crop is lost.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Temperature = message_type("sensor_msgs/msg/Temperature")
Illuminance = message_type("sensor_msgs/msg/Illuminance")

MINUTE = 60.0
DURATION = 120
SCORCHED, CHILLED = 32.5, 16.0
SHADED = 25.0  # light under the net, klx


class Greenhouse:
    """A greenhouse under a shading net that a storm may tear; from then on, `torn` multiplies the sunlight."""

    def __init__(self, rng, torn):
        self.rng = rng
        self.torn = torn
        self.storm = rng.integers(25, 40)
        self.outside = rng.uniform(15.0, 17.0)
        self.air = rng.uniform(22.0, 25.0)
        self.cloud = 1.0
        self.minute = 0
        self.opening = 0.0
        self.failure = ""

    @property
    def light(self):
        """Return the light inside, klx."""
        return SHADED * self.cloud * (self.torn if self.minute >= self.storm else 1.0)

    def publish(self, bus):
        """Publish the measurements of the weather station."""
        bus.publish("/light", Illuminance(illuminance=1000.0 * self.light))
        bus.publish("/air", Temperature(temperature=self.air + self.rng.normal(0.0, 0.1)))

    def advance(self, vent, lamp):
        """Let a minute pass."""
        self.opening = max(0.0, min(1.0, vent.data)) if vent else 0.0
        heat = 0.032 * self.light + (0.05 * lamp.data if lamp else 0.0)
        leak = 0.035 + 0.3 * self.opening
        self.air += heat - leak * (self.air - self.outside)
        self.cloud = min(1.0, max(0.85, self.cloud + self.rng.normal(0.0, 0.03)))
        self.minute += 1

    def judge(self):
        """Return the reward of the minute, which is 0 before the end."""
        if self.air > SCORCHED:
            self.failure = "scorched"
        elif self.air < CHILLED:
            self.failure = "chilled"
        if self.failure:
            return -10.0
        return 10.0 if self.minute == DURATION else 0.0


@pytest.mark.tarl(
    nodes=["vent.py"],
    sensors=[
        Sensor("air", topic="/air", field="temperature", low=18, high=34, bins=16, unit="°C"),
        Sensor("light", topic="/light", field="illuminance", low=0, high=80000, bins=16, unit="lx"),
    ],
    drifts={"torn net": 3.0},
    episodes=100,
    min_success=0.95,
)
def test_spares_the_crop(tarl, tarl_drift):
    """Come through the noon."""
    greenhouse = Greenhouse(tarl.rng("greenhouse"), tarl_drift or 1.0)
    tarl.start("vent.py")
    while greenhouse.minute < DURATION and not greenhouse.failure:
        greenhouse.publish(tarl.bus)
        tarl.step(MINUTE)
        greenhouse.advance(tarl.bus.latest("/vent"), tarl.bus.latest("/lamp"))
        tarl.reward(greenhouse.judge())
    assert not greenhouse.failure, greenhouse.failure
