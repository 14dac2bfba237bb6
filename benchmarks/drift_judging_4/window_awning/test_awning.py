"""An awning follows the sun. Under scattered clouds the light flickers, and frequent starts overheat the motor."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")
Float64MultiArray = message_type("std_msgs/Float64MultiArray")
String = message_type("std_msgs/String")

DT = 2.0  # s
STEPS = 180
TRAVEL = 0.12  # change in one step, as a share of the awning
PLAY = 0.04  # smaller movements are ignored by the drive
START_HEAT = 1.0  # heat per start or reversal
COOLING = 0.012  # share of the heat that the motor loses in a step
HOT = 26.0
NEAR = 0.35  # tolerated difference from the share that the mean light needs


class Facade:
    """A sunny window whose light flickers by a share `flicker`."""

    def __init__(self, rng, flicker):
        self.rng = rng
        self.weather = "clear" if flicker < 0.1 else "scattered"
        self.flicker = flicker
        self.elevation = rng.uniform(25.0, 50.0)
        self.start, self.end = rng.uniform(46.0, 55.0), rng.uniform(60.0, 69.0)
        if rng.random() < 0.5:
            self.start, self.end = self.end, self.start
        self.cloud = 0.0
        self.out = self.needed()
        self.heat, self.moving, self.beside = 0.0, 0, 0
        self.step = 0
        self.failure = ""

    @property
    def done(self):
        """Return whether the time is over or the motor is too hot."""
        return self.step >= STEPS or bool(self.failure)

    @property
    def mean(self):
        """Return the light without the flicker, klx."""
        step = getattr(self, "step", 0)
        return self.start + (self.end - self.start) * step / STEPS

    def needed(self):
        """Return the shade that the mean light needs."""
        klx = self.mean * (1.0 + 0.2 * math.cos(math.radians(self.elevation)))
        return max(0.0, min(1.0, (klx - 20.0) / 80.0))

    def publish(self, bus):
        """Publish weather, light, wind and the position of the sun."""
        self.cloud = 0.5 * self.cloud + self.rng.normal(0.0, self.flicker)
        klx = self.mean * max(0.2, 1.0 + self.cloud)
        bus.publish("weather/sky", String(data=self.weather))
        bus.publish("facade/sun", Float64(data=klx))
        bus.publish("facade/wind", Float64(data=abs(self.rng.normal(3.0, 1.0))))
        bus.publish("ephemeris", Float64MultiArray(data=[170.0, self.elevation]))

    def advance(self, target):
        """Move for one step."""
        self.step += 1
        wanted = max(0.0, min(1.0, target.data)) if target else self.out
        way = wanted - self.out
        direction = 0 if abs(way) < PLAY else (1 if way > 0.0 else -1)
        if direction and direction != self.moving:
            self.heat += START_HEAT
        self.moving = direction
        self.heat *= 1.0 - COOLING
        if direction:
            self.out += max(-TRAVEL, min(TRAVEL, way))

    def judge(self):
        """Return the reward of the step, for shade that suits the light and for a cool motor."""
        off = abs(self.out - self.needed())
        self.beside += off > NEAR
        if self.heat > HOT:
            self.failure = "the motor is too hot"
            return -6.0
        if self.done and self.beside > 0.1 * STEPS:
            self.failure = "too much or too little shade"
            return -6.0
        return 10.0 / STEPS * max(-1.0, 1.0 - (off / NEAR) ** 2)


@pytest.mark.tarl(
    nodes=["awning.py"],
    sensors=[
        Sensor("sky", topic="weather/sky", field="data", categories=("clear", "scattered")),
        Sensor("sun", topic="facade/sun", field="data", low=20, high=100, bins=6, unit="klx"),
    ],
    drifts={"scattered clouds": 0.3},
    episodes=100,
    min_success=0.95,
)
def test_shades(tarl, tarl_drift):
    """Shade a window for six minutes."""
    facade = Facade(tarl.rng("facade"), tarl_drift or 0.01)
    tarl.start("awning.py")
    while not facade.done:
        facade.publish(tarl.bus)
        tarl.step(DT)
        facade.advance(tarl.bus.latest("awning/target"))
        tarl.reward(facade.judge())
    assert not facade.failure, facade.failure
