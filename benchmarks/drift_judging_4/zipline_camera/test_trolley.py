"""A camera on a zip line stops at its mark. On a wet rope the pads brake less, so the camera overruns."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float64 = message_type("std_msgs/Float64")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 0.1
NEAR = 1.2  # m
TIME_BOUND = 30.0


class Rope:
    """A falling rope; the brake pads decelerate by about `pads` (m/s²) on the level."""

    def __init__(self, rng, pads):
        self.rng = rng
        self.rain = pads < 2.0
        self.pads = pads * rng.uniform(0.98, 1.02)
        self.slope = math.radians(rng.uniform(3.0, 5.0))
        self.mark = rng.uniform(28.0, 40.0)
        self.place, self.speed = 0.0, 0.0
        self.was_braking, self.stopped = False, False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the trolley has stopped or the time is over."""
        return self.stopped or bool(self.failure)

    def publish(self, bus):
        """Publish mark, weather, encoder and inclinometer."""
        bus.publish("mission/mark", Float64(data=self.mark))
        bus.publish("weather/rain", Bool(data=self.rain))
        seen = (self.place + self.rng.normal(0.0, 0.02), self.speed + self.rng.normal(0.0, 0.02))
        bus.publish("trolley/encoder", Vector3(seen[0], seen[1], 0.0))
        bus.publish("rope/inclination", Float64(data=math.degrees(self.slope) + self.rng.normal(0.0, 0.05)))

    def advance(self, drive, brake):
        """Ride or brake for one step."""
        if brake and brake.data:
            self.speed -= (self.pads - 9.81 * math.sin(self.slope)) * DT
            self.was_braking = True
            if self.speed <= 0.0:
                self.speed, self.stopped = 0.0, True
        elif drive:
            wanted = max(0.0, min(5.0, drive.data))
            self.speed += max(-0.08, min(0.08, wanted - self.speed))
        self.place += self.speed * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: a little for time, most for the place where the trolley stops."""
        miss = self.place - self.mark
        if self.time > TIME_BOUND and not self.stopped:
            self.failure = "late"
        elif miss > 4.0 or (self.stopped and abs(miss) > NEAR):
            self.failure = f"{miss:.1f} m away from the mark"
        if self.failure:
            return -5.0
        return 10.0 - 2.0 * abs(miss) if self.stopped else -0.005


@pytest.mark.tarl(
    nodes=["trolley.py", "braking.py"],
    sensors=[
        Sensor("rain", topic="weather/rain", field="data"),
        Sensor("place", topic="trolley/encoder", field="x", low=0, high=40, bins=8, unit="m"),
        Sensor("speed", topic="trolley/encoder", field="y", low=0, high=5, bins=4, unit="m/s"),
    ],
    drifts={"wet rope": 1.7},
    episodes=100,
    min_success=0.95,
)
def test_stops_at_its_mark(tarl, tarl_drift):
    """Ride to one mark."""
    rope = Rope(tarl.rng("rope"), tarl_drift or 2.4)
    tarl.start("trolley.py")
    while not rope.done:
        rope.publish(tarl.bus)
        tarl.step(DT)
        rope.advance(tarl.bus.latest("trolley/speed"), tarl.bus.latest("trolley/brake"))
        tarl.reward(rope.judge())
    assert not rope.failure, rope.failure
