"""A ferris wheel stops its gondolas at a platform. In fog its rim is wet and its brake weak, and gondolas go past."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
RelativeHumidity = message_type("sensor_msgs/RelativeHumidity")

DT = 0.1
STOPS = 3
PITCH = math.pi / 6.0
STEP = 0.05  # a gap that a foot cannot bridge (rad)
TIME_BOUND = 38.0


class Wheel:
    """A wheel with a load that is not balanced, and a brake on its rim."""

    def __init__(self, rng, decel, humidity):
        self.rng = rng
        self.decel = decel * rng.uniform(0.96, 1.04)
        self.humidity = humidity + rng.uniform(-4.0, 4.0)
        self.delay = rng.uniform(0.2, 0.3)
        self.unbalance = rng.uniform(0.0, 0.0015), rng.uniform(0.0, 2.0 * math.pi)
        self.angle, self.speed = 0.0, 0.0
        self.braked = 1.0
        self.time, self.stops, self.open = 0.0, 0, 0.0
        self.seen = None
        self.gained = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether enough people are on board, or the ride has ended."""
        return bool(self.failure) or self.stops == STOPS

    def publish(self, bus):
        """Publish the angle of the wheel, the air and the door of the platform."""
        bus.publish("wheel/angle", Float32(data=self.angle + self.rng.normal(0.0, 0.0004)))
        bus.publish(
            "weather/humidity", RelativeHumidity(relative_humidity=self.humidity + self.rng.normal(0.0, 0.5))
        )
        bus.publish("platform/door", Bool(data=self.open > 0.0))

    def advance(self, drive, brake, at_platform):
        """Turn for one step; people board when the node reports a gondola at the platform."""
        self.braked = self.braked + DT if brake is None or brake.data else 0.0
        size, phase = self.unbalance
        gravity = size * math.sin(self.angle + phase)
        if self.braked > self.delay:
            self.speed = max(0.0, self.speed - (self.decel + gravity) * DT)
        elif drive is not None and drive.data > 0.0:
            self.speed += (drive.data - self.speed) * (1.0 - math.exp(-DT / 0.4)) + gravity * DT
        else:
            self.speed = max(0.0, self.speed + gravity * DT)
        self.angle += self.speed * DT
        self.time += DT
        self.open = max(0.0, self.open - DT)
        self.gained = -0.002
        if at_platform is not None and at_platform is not self.seen:
            self.seen = at_platform
            self._board(abs(self.angle - at_platform.data * PITCH))

    def _board(self, gap):
        self.stops += 1
        self.open = self.rng.uniform(2.0, 3.5)
        if gap > STEP:
            self.failure = f"gondola is {math.degrees(gap):.1f} degrees from the platform"
        else:
            self.gained += 10.0 / STOPS * (1.0 - 0.3 * (gap / STEP) ** 2)

    def judge(self):
        """Return the reward of the step: people who board."""
        if self.time > TIME_BOUND:
            self.failure = "boarding takes too long"
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["ferris_wheel.py"],
    sensors=[
        Sensor(
            "humidity",
            topic="weather/humidity",
            field="relative_humidity",
            low=20.0,
            high=100.0,
            bins=8,
            unit="%",
        ),
        Sensor("angle", topic="wheel/angle", field="data", low=0.0, high=1.6, bins=6, unit="rad"),
        Sensor("door", topic="platform/door", field="data"),
    ],
    drifts={"fog": {"decel": 0.033, "humidity": 94.0}},
    episodes=200,
    min_success=0.97,
)
def test_boards(tarl, tarl_drift):
    """Let people board three gondolas."""
    wheel = Wheel(tarl.rng("wheel"), **(tarl_drift or {"decel": 0.055, "humidity": 60.0}))
    tarl.start("ferris_wheel.py")
    while not wheel.done:
        wheel.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        wheel.advance(latest("wheel/drive"), latest("wheel/brake"), latest("platform/gondola"))
        tarl.reward(wheel.judge())
    assert not wheel.failure, wheel.failure
