"""A robot guides four visitors. On a day of free entry the halls are crowded, and who falls back loses sight of it.

Each exhibit with the whole group earns, seconds cost a little, and a lost visitor ends the tour.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")
Pose2D = message_type("geometry_msgs/Pose2D")

DT = 0.2
QUIET = {"sight": 9.0}
CROWDED = {"sight": 3.5}  # m


class Visitor:
    """A visitor who walks behind the guide, and at times stops to look."""

    def __init__(self, rng, place):
        self.rng = rng
        self.at = [-1.2 - 0.3 * place, 0.4 * (place % 2)]
        self.pace = float(rng.uniform(1.05, 1.35))
        self.near = 1.0 + 0.3 * place
        self.look = float(rng.uniform(3.0, 6.0))  # s until the next stop
        self.stop = 0.0
        self.unseen = 0.0

    def walk(self, guide, sight):
        """Walk for one step; return the distance to the guide."""
        dx, dy = guide[0] - self.at[0], guide[1] - self.at[1]
        away = math.hypot(dx, dy)
        self.look -= DT
        if self.look < 0.0:
            self.stop = float(self.rng.uniform(3.5, 5.0))
            self.look = self.stop + float(self.rng.uniform(6.0, 10.0))
        if self.stop > 0.0:
            self.stop -= DT
        elif away > self.near:
            way = min(self.pace, 1.5 * (away - self.near)) * DT
            self.at[0] += way * dx / away
            self.at[1] += way * dy / away
        self.unseen = self.unseen + DT if away > sight else 0.0
        return away


class Museum:
    """A museum in which visitors see the guide up to a distance `sight`."""

    def __init__(self, rng, sight):
        self.rng = rng
        self.sight = sight * rng.normal(1.0, 0.02)
        self.visitors = [Visitor(rng, place) for place in range(4)]
        self.x, self.y, self.heading = 0.0, 0.0, float(rng.uniform(-0.5, 0.5))
        self.speed = 0.0
        self.farthest = 2.0
        self.visited = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the tour is over."""
        return bool(self.failure) or self.visited >= 3

    def publish(self, bus):
        """Publish the pose and the group."""
        noise = self.rng.normal(0.0, 0.01, 3)
        pose = Pose2D(x=self.x + noise[0], y=self.y + noise[1], theta=self.heading + noise[2])
        bus.publish("odom/pose", pose)
        bus.publish("group/farthest", Float32(data=self.farthest + self.rng.normal(0.0, 0.04)))
        if round(self.time / DT) % 5 == 0:
            bus.publish("group/count", Int32(data=4))

    def advance(self, command, visited):
        """Walk for one step."""
        self.time += DT
        self.gained = -0.0005
        self.speed += 0.5 * ((command.linear.x if command else 0.0) - self.speed)
        self.heading += DT * (command.angular.z if command else 0.0)
        self.x += DT * self.speed * math.cos(self.heading)
        self.y += DT * self.speed * math.sin(self.heading)
        self.farthest = max(visitor.walk((self.x, self.y), self.sight) for visitor in self.visitors)
        if visited and visited.data > self.visited:
            self.visited = visited.data
            self.gained += 2.5
        if any(visitor.unseen > 1.5 for visitor in self.visitors):
            self.failure = "visitor is lost"
        elif self.time > 120.0:
            self.failure = "museum closes"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["museum_guide.py"],
    sensors=[
        Sensor("farthest", topic="group/farthest", field="data", low=0.0, high=8.0, bins=8, unit="m"),
        Sensor("x", topic="odom/pose", field="x", low=-2.0, high=16.0, bins=6, unit="m"),
    ],
    drifts={"crowded": CROWDED},
    episodes=200,
    min_success=0.97,
)
def test_guides(tarl, tarl_drift):
    """Guide one group to three exhibits: 2.5 for each, a small cost per second, -4 for a lost visitor."""
    museum = Museum(tarl.rng("museum"), **(tarl_drift or QUIET))
    tarl.start("museum_guide.py")
    while not museum.done:
        museum.publish(tarl.bus)
        tarl.step(DT)
        museum.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("guide/visited"))
        tarl.reward(museum.gained)
    assert not museum.failure, museum.failure
