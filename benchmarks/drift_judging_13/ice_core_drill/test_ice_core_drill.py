"""A drill brings up a core of ice. In warm ice its chips stick and jam it; only the core at the surface is rewarded."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Temperature = message_type("sensor_msgs/Temperature")

DT = 0.5
CORE = 1.75  # m
LEVELS = 0.9  # amount of chips that jams the barrel, in m of core
TIME_BOUND = 230.0
COLD, WARM = -18.0, -1.5  # °C


class Hole:
    """A hole in a glacier whose ice has a temperature in °C; warm chips are wet and pack."""

    def __init__(self, rng, celsius):
        self.rng = rng
        self.celsius = celsius + rng.uniform(-1.2, 1.2)
        self.packing = (1.0 if self.celsius < -5.0 else 1.75) * rng.uniform(0.95, 1.05)
        self.bottom = rng.uniform(6.0, 8.0)
        self.start = self.bottom
        self.depth = 0.0
        self.chips = 0.0
        self.amps = 0.0
        self.time = 0.0
        self.landed = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the drill is up, stuck or late."""
        return bool(self.failure) or self.landed

    def publish(self, bus):
        """Publish the depths, the current of the motor and the temperature at the bit."""
        bus.publish("winch/depth", Float32(data=self.depth + self.rng.normal(0.0, 0.002)))
        bus.publish("hole/bottom", Float32(data=self.bottom))
        bus.publish("drill/current", Float32(data=self.amps + self.rng.normal(0.0, 0.3)))
        share = min(1.0, self.depth / 5.0)
        celsius = -8.0 + share * (self.celsius + 8.0)
        bus.publish("hole/temperature", Temperature(temperature=celsius + self.rng.normal(0.0, 0.2)))

    def advance(self, speed, rpm, back):
        """Move the drill for one step."""
        winch = (speed.data if speed else 0.0) * self.rng.uniform(0.98, 1.02)
        turning = rpm.data if rpm else 0.0
        self.depth = max(0.0, self.depth + winch * DT)
        self.amps = 1.0 + 0.02 * turning
        if self.depth > self.bottom:
            cut = min(self.depth - self.bottom, 0.0003 * turning * DT)
            self.bottom += cut
            self.depth = self.bottom
            self.chips += cut * self.packing * self.rng.uniform(0.9, 1.1)
            self.amps += 2.0 + 3.0 * self.chips / LEVELS
        elif self.bottom - self.depth > 0.6:
            self.chips = 0.0
        self.time += DT
        if self.chips > LEVELS:
            self.failure = f"the drill is stuck at {self.depth:.1f} m"
        elif self.time > TIME_BOUND:
            self.failure = "the weather turns"
        elif back is not None and back.data:
            self.landed = True
            if self.bottom - self.start < CORE:
                self.failure = "the core is short"

    def judge(self):
        """Return the reward of the step: a core at the surface."""
        return 10.0 if self.landed and not self.failure else 0.0


@pytest.mark.tarl(
    nodes=["ice_core_drill.py"],
    sensors=[
        Sensor(
            "celsius", topic="hole/temperature", field="temperature", low=-24.0, high=0.0, bins=8, unit="°C"
        ),
        Sensor("depth", topic="winch/depth", field="data", low=0.0, high=10.0, bins=5, unit="m"),
        Sensor("current", topic="drill/current", field="data", low=0.0, high=10.0, bins=4, unit="A"),
    ],
    drifts={"warm ice": Drift(WARM)},
    episodes=200,
    min_success=0.97,
)
def test_drills(tarl, tarl_drift):
    """Drill one core."""
    hole = Hole(tarl.rng("hole"), tarl_drift or COLD)
    tarl.start("ice_core_drill.py")
    while not hole.done:
        hole.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        hole.advance(latest("winch/speed"), latest("drill/rpm"), latest("mission/done"))
        tarl.reward(hole.judge())
    assert not hole.failure, hole.failure
