"""A kite flies figures of eight. In a fresh wind, it flies and turns faster, and its steering lags as before."""

import math
from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
String = message_type("std_msgs/msg/String")
Vector3Stamped = message_type("geometry_msgs/msg/Vector3Stamped")

DT = 0.1
LIGHT, FRESH = 6.0, 12.0  # m/s


class Window:
    """The window of a kite in some `wind`, in m/s, at the end of lines of 60 m."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.wind = wind * rng.normal(1.0, 0.03)
        self.turns = 0.13 * rng.normal(1.0, 0.04)  # rad per m at full steering
        self.bridle = rng.normal(0.0, 0.01)
        self.azimuth, self.elevation = float(rng.uniform(-0.1, 0.1)), 0.8
        self.course, self.steer = rng.normal(0.0, 0.2), 0.0
        self.radio = deque([0.0, 0.0], maxlen=3)  # commands on their way to the pod
        self.heat = 0.0
        self.gust, self.side, self.swings = 0.0, 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the flight is over."""
        return bool(self.failure) or self.time >= 30.0

    def publish(self, bus):
        """Publish the line angles, and every second the wind at the winch and the mode."""
        seen = Vector3Stamped()
        seen.vector.x = self.azimuth + self.rng.normal(0.0, 0.004)
        seen.vector.y = self.elevation + self.rng.normal(0.0, 0.004)
        seen.vector.z = math.remainder(self.course + self.rng.normal(0.0, 0.04), 2.0 * math.pi)
        if round(self.time / DT) % 10 == 0:
            bus.publish("winch/wind", Float32(data=self.wind + self.gust + self.rng.normal(0.0, 0.4)))
            bus.publish("operator/mode", String(data="eight"))
        bus.publish("kite/position", seen)

    def advance(self, steer):
        """Fly for one step."""
        self.time += DT
        self.gained = 0.0
        self.gust += -0.05 * self.gust + self.rng.normal(0.0, 0.06)
        self.radio.append(steer.data if steer else 0.0)
        before = self.steer
        for _ in range(2):  # half steps, since the kite turns fast
            self.steer += 0.2 * (self.radio[0] - self.steer)
            speed = (
                3.0 * (self.wind + self.gust) * max(0.1, math.cos(self.azimuth) * math.cos(self.elevation))
            )
            weight = 8.0 * math.sin(self.course) * math.cos(self.elevation) / speed  # turns a slow kite down
            self.course += 0.5 * DT * (speed * self.turns * (self.steer + self.bridle) + weight)
            self.elevation += 0.5 * DT * speed / 60.0 * math.cos(self.course)
            self.azimuth += (
                0.5 * DT * speed / 60.0 * math.sin(self.course) / max(0.2, math.cos(self.elevation))
            )
        self.heat += abs(self.steer - before) - 0.035 * self.heat
        side = (self.azimuth > 0.25) - (self.azimuth < -0.25)
        if side and side != self.side:
            self.side = side
            self.swings += 1
        self.gained = 0.04 * math.cos(self.elevation) * math.cos(self.azimuth) - 0.01 * abs(self.steer)
        if self.elevation < 0.06:
            self.failure = "kite hits the ground"
        elif self.heat > 4.2:
            self.failure = "motor of the pod overheats"
        elif abs(self.azimuth) > 1.2:
            self.failure = "kite leaves the window"
        elif self.time >= 30.0:
            self.gained += min(6.0, 2.0 * (self.swings - 1))
            if self.swings < 4:
                self.failure = "kite does not fly eights"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["power_kite.py"],
    sensors=[
        Sensor("wind", topic="winch/wind", field="data", low=2.0, high=18.0, bins=8, unit="m/s"),
        Sensor("azimuth", topic="kite/position", field="vector.x", low=-0.8, high=0.8, bins=8, unit="rad"),
    ],
    drifts={"fresh": FRESH},
    episodes=200,
    min_success=0.97,
    tolerance=1.0,  # the motor of the pod works harder in more wind
)
def test_flies(tarl, tarl_drift):
    """Fly for half a minute."""
    window = Window(tarl.rng("window"), tarl_drift or LIGHT)
    tarl.start("power_kite.py")
    while not window.done:
        window.publish(tarl.bus)
        tarl.step(DT)
        window.advance(tarl.bus.latest("kite/steer"))
        tarl.reward(window.gained)
    assert not window.failure, window.failure
