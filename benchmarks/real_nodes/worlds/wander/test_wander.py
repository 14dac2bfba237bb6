"""rosbook's wander.py drives about in a room without touching a wall. A heavy load makes the base respond slowly."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

LaserScan = message_type("sensor_msgs/LaserScan")
Float32 = message_type("std_msgs/Float32")

NODE = "wanderbot/wander.py"
DT = 0.1
TIME = 25.0
ROOM = 3.5  # half of the room's width, m
RADIUS = 0.25
RAYS = [math.radians(angle) for angle in range(-40, 41, 10)]


class Room:
    """A square room; `load` in kg sets how slowly the base follows its command."""

    def __init__(self, rng, load):
        self.rng = rng
        self.load = load
        self.lag = 0.15 + 0.01 * load  # s
        self.x, self.y = rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)
        self.heading = rng.uniform(-math.pi, math.pi)
        self.speed, self.turn = 0.0, 0.0
        self.time = 0.0
        self.failure = ""

    def ray(self, angle):
        """Return the distance to the wall in a direction, m."""
        cos, sin = math.cos(self.heading + angle), math.sin(self.heading + angle)
        along = ((ROOM - self.x if cos > 0 else -ROOM - self.x) / cos) if abs(cos) > 1e-6 else 99.0
        across = ((ROOM - self.y if sin > 0 else -ROOM - self.y) / sin) if abs(sin) > 1e-6 else 99.0
        return min(along, across)

    def publish(self, bus):
        """Publish the measurements of scanner and scales."""
        bus.publish("/load", Float32(data=self.load))
        bus.publish("/scan", LaserScan(ranges=[self.ray(a) + self.rng.normal(0.0, 0.01) for a in RAYS]))

    def advance(self, cmd):
        """Drive for one step."""
        if cmd:
            self.speed += (cmd.linear.x - self.speed) * min(1.0, DT / self.lag)
            self.turn += (cmd.angular.z - self.turn) * min(1.0, DT / self.lag)
        self.heading += self.turn * DT
        self.x += self.speed * math.cos(self.heading) * DT
        self.y += self.speed * math.sin(self.heading) * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress, unless a wall is touched."""
        if max(abs(self.x), abs(self.y)) > ROOM - RADIUS:
            self.failure = "touched a wall"
            return -10.0
        return self.speed * DT


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("load", topic="/load", field="data", low=0, high=100, bins=4, unit="kg"),
        Sensor("ahead", topic="/scan", field="ranges.4", low=0, high=4, bins=8, unit="m"),
    ],
    drifts={"heavy load": 55.0},
    episodes=60,
    min_success=0.95,
)
def test_touches_no_wall(tarl, tarl_drift):
    """Wander."""
    room = Room(tarl.rng("room"), tarl_drift or 0.0)
    tarl.start(NODE)
    while room.time < TIME and not room.failure:
        room.publish(tarl.bus)
        tarl.step(DT)
        room.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(room.judge())
    assert not room.failure, room.failure
