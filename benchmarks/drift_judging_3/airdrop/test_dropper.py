"""A parcel lands near its addressee; only the landing is rewarded. Under a larger chute it drifts further."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
Point = message_type("geometry_msgs/msg/Point")
String = message_type("std_msgs/msg/String")
Vector3 = message_type("geometry_msgs/msg/Vector3")

DT = 0.2
SPEED = 15.0
NEAR = 14.0  # m
TIME_BOUND = 60.0


class Sky:
    """A drone with a parcel whose chute sinks with `sink` m/s."""

    def __init__(self, rng, sink):
        self.rng = rng
        self.chute = "small" if sink > 5.0 else "large"
        self.sink = sink * rng.uniform(0.97, 1.03)
        bearing, blow = rng.uniform(0.0, 2.0 * math.pi, 2)
        start = rng.uniform(300.0, 420.0)
        self.x, self.y = start * math.cos(bearing), start * math.sin(bearing)
        self.height = rng.uniform(55.0, 85.0)
        strength = rng.uniform(2.5, 5.0)
        self.wind = (strength * math.cos(blow), strength * math.sin(blow))
        self.course = bearing + math.pi
        self.velocity = (0.0, 0.0)
        self.miss = None
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the parcel lies on the ground, or the episode has failed."""
        return self.miss is not None or bool(self.failure)

    def publish(self, bus):
        """Publish mission, label, position and the autopilot's estimate of the wind."""
        bus.publish("parcel/chute", String(data=self.chute))
        bus.publish("mission/target", Point(x=0.0, y=0.0, z=0.0))
        gusts = self.rng.normal(0.0, 0.2, 2)
        bus.publish("autopilot/wind", Vector3(x=self.wind[0] + gusts[0], y=self.wind[1] + gusts[1], z=0.0))
        bus.publish("gps", Point(x=self.x, y=self.y, z=self.height))

    def advance(self, course, release):
        """Fly for one step; a released parcel lands in the same step."""
        if release and release.data:
            down = 1.2 + (self.height - 4.8) / self.sink
            at = (
                where + wind * down + speed * 0.9
                for where, wind, speed in zip((self.x, self.y), self.wind, self.velocity, strict=True)
            )
            self.miss = math.hypot(*at)
        if course:
            turn = math.remainder(course.data - self.course, 2.0 * math.pi)
            self.course += max(-0.5 * DT, min(0.5 * DT, turn))
        self.velocity = (
            SPEED * math.cos(self.course) + self.wind[0],
            SPEED * math.sin(self.course) + self.wind[1],
        )
        self.x += self.velocity[0] * DT
        self.y += self.velocity[1] * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step, which is 0 before the parcel has landed."""
        if self.time > TIME_BOUND:
            self.failure = "never released"
        elif self.miss is None:
            return 0.0
        elif self.miss > NEAR:
            self.failure = f"landed {self.miss:.0f} m away"
        return -5.0 if self.failure else 10.0 - 0.15 * self.miss


@pytest.mark.tarl(
    nodes=["dropper.py", "ballistics.py"],
    sensors=[
        Sensor("chute", topic="parcel/chute", field="data", categories=("small", "large")),
        Sensor("height", topic="gps", field="z", low=55, high=85, bins=3, unit="m"),
    ],
    drifts={"large chute": 3.6},
    episodes=100,
    min_success=0.95,
)
def test_drops(tarl, tarl_drift):
    """Deliver one parcel."""
    sky = Sky(tarl.rng("sky"), tarl_drift or 6.0)
    tarl.start("dropper.py")
    while not sky.done:
        sky.publish(tarl.bus)
        tarl.step(DT)
        sky.advance(tarl.bus.latest("autopilot/course"), tarl.bus.latest("hook/release"))
        tarl.reward(sky.judge())
    assert not sky.failure, sky.failure
