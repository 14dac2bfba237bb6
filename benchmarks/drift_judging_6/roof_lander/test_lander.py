"""A multirotor lands on a marker in the court. On the new roof, a gust over the parapet hits one landing in nine."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PoseStamped = message_type("geometry_msgs/PoseStamped")
TwistStamped = message_type("geometry_msgs/TwistStamped")
String = message_type("std_msgs/String")

DT = 0.1
PAD, FENCE = 0.6, 2.2  # distances from the marker (m)
TIME_BOUND = 25.0


class Roof:
    """A multirotor above a pad, in wind."""

    def __init__(self, rng, risk):
        self.rng = rng
        self.position = [rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(3.5, 4.5)]
        self.velocity = [0.0, 0.0]
        self.tilt = [0.0, 0.0]
        bearing, wind = rng.uniform(0.0, 2 * math.pi), rng.uniform(0.0, 0.4)
        self.wind = [wind * math.cos(bearing), wind * math.sin(bearing)]
        gust, size, start = rng.random() < risk, rng.uniform(2.6, 3.0), rng.uniform(3.0, 4.5)
        bearing = rng.uniform(0.0, 2 * math.pi)
        self.gust = [size * gust * math.cos(bearing), size * gust * math.sin(bearing)]
        self.blows = (start, start + 2.5)
        self.time = 0.0
        self.failure = ""

    @property
    def off(self):
        """Return the distance from the marker, m."""
        return math.hypot(*self.position[:2])

    @property
    def landed(self):
        """Return whether the skids touch the roof."""
        return self.position[2] <= 0.0

    @property
    def done(self):
        """Return whether the landing is over."""
        return self.landed or bool(self.failure)

    def publish(self, bus):
        """Publish the marker position from the camera, and the speed."""
        speed, marker = TwistStamped(), PoseStamped()
        speed.twist.linear.x, speed.twist.linear.y = (v + self.rng.normal(0.0, 0.03) for v in self.velocity)
        marker.pose.position.x, marker.pose.position.y = (
            -p + self.rng.normal(0.0, 0.02) for p in self.position[:2]
        )
        marker.pose.position.z = -self.position[2] + self.rng.normal(0.0, 0.02)
        bus.publish("velocity", speed)
        bus.publish("marker", marker)

    def advance(self, command):
        """Fly for one step."""
        self.time += DT
        blowing = self.blows[0] < self.time < self.blows[1]
        aims = (command.x, command.y) if command else (0.0, 0.0)
        for axis, aim in enumerate(aims):
            self.tilt[axis] += 0.5 * (aim - self.tilt[axis])
            push = 9.81 * math.tan(self.tilt[axis]) + self.wind[axis] + self.gust[axis] * blowing
            drag = 0.15 * self.velocity[axis]
            self.velocity[axis] += (push - drag + self.rng.normal(0.0, 0.2)) * DT
            self.position[axis] += self.velocity[axis] * DT
        self.position[2] -= (command.z if command else 0.0) * DT

    def judge(self):
        """Return the reward of the step: 10 for a landing on the pad, minus a cost of time."""
        if self.off > FENCE:
            self.failure = "beyond the parapet"
        elif self.landed and self.off > PAD:
            self.failure = f"landed {self.off:.1f} m away from the marker"
        elif self.time > TIME_BOUND:
            self.failure = "out of battery"
        if self.failure:
            return -5.0
        return -0.01 + 10.0 * self.landed


@pytest.mark.tarl(
    nodes=["lander.py"],
    sensors=[
        Sensor("east", topic="marker", field="pose.position.x", edges=(-1.0, -0.4, 0.4, 1.0), unit="m"),
        Sensor("north", topic="marker", field="pose.position.y", edges=(-1.0, -0.4, 0.4, 1.0), unit="m"),
        Sensor("state", topic="lander/state", field="data", categories=("approach", "descend", "landed")),
    ],
    drifts={"gusts": 0.11},
    episodes=150,
    min_success=0.97,
)
def test_lands(tarl, tarl_drift):
    """Land once."""
    roof = Roof(tarl.rng("roof"), tarl_drift or 0.0)
    tarl.start("lander.py")
    while not roof.done:
        roof.publish(tarl.bus)
        tarl.step(DT)
        roof.advance(tarl.bus.latest("command"))
        tarl.reward(roof.judge())
    assert not roof.failure, roof.failure
