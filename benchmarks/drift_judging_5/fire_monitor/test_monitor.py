"""A water cannon puts out a fire. Against the wind its jet falls short."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Point = message_type("geometry_msgs/Point")

DT = 0.2
REACH = 60.0  # throw distance in still air (m)
BRAKE = 0.045  # share of the throw distance that 1 m/s of head wind takes away
NEAR = 2.2  # distance from the fire within which water helps (m)
NEEDED = 6.0  # time with water on the fire (s)
TIME_BOUND = 25.0


class Yard:
    """A burning heap in a yard with a head wind."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.wind = wind + rng.uniform(-0.4, 0.4)
        self.distance = float(rng.uniform(24.0, 38.0))
        self.bearing = float(rng.uniform(-0.5, 0.5))
        self.elevation, self.azimuth = 0.0, 0.0
        self.water = self.gained = 0.0
        self.time = 0.0
        self.failure = ""

    @property
    def out(self):
        """Return whether the fire is out."""
        return self.water >= NEEDED

    @property
    def done(self):
        """Return whether the mission is over."""
        return self.out or bool(self.failure)

    def publish(self, bus):
        """Publish the measurements of camera and anemometer."""
        far = self.distance + self.rng.normal(0.0, 0.4)
        spot = Point(x=far * math.cos(self.bearing), y=far * math.sin(self.bearing), z=0.0)
        bus.publish("camera/hotspot", spot)
        bus.publish("camera/out", Bool(data=self.out))
        bus.publish("mast/head_wind", Float32(data=self.wind + self.rng.normal(0.0, 0.2)))

    def advance(self, elevation, azimuth, valve):
        """Turn the cannon and let the water fall; return the reward."""
        if elevation and azimuth:
            turn = math.atan(azimuth.data) - self.azimuth
            self.elevation += max(-2.5, min(2.5, elevation.data - self.elevation))
            self.azimuth += max(-0.1, min(0.1, turn))
        throw = REACH * math.sin(math.radians(2.0 * max(0.0, min(45.0, self.elevation))))
        throw *= 1.0 - BRAKE * self.wind
        aside = self.distance * abs(self.bearing - self.azimuth)
        self.time += DT
        if valve and valve.data and math.hypot(throw - self.distance, aside) < NEAR:
            self.water += DT
            return 10.0 * DT / NEEDED - 0.004
        if self.time > TIME_BOUND:
            self.failure = f"{self.water:.1f} s of water, so the fire spreads"
            return -3.0
        return -0.004


@pytest.mark.tarl(
    nodes=["monitor.py", "ballistics.py"],
    sensors=[
        Sensor("wind", topic="mast/head_wind", field="data", low=-2, high=8, bins=5),
        Sensor("ahead", topic="camera/hotspot", field="x", low=18, high=40, bins=3),
    ],
    drifts={"head wind": 5.0},
    episodes=100,
    min_success=0.95,
)
def test_extinguishes(tarl, tarl_drift):
    """Put out one fire."""
    yard = Yard(tarl.rng("yard"), tarl_drift or 0.0)
    tarl.start("monitor.py")
    while not yard.done:
        yard.publish(tarl.bus)
        tarl.step(DT)
        topics = ("monitor/elevation", "monitor/azimuth", "monitor/valve")
        tarl.reward(yard.advance(*(tarl.bus.latest(topic) for topic in topics)))
    assert not yard.failure, yard.failure
