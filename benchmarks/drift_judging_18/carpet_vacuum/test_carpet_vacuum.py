"""A vacuum robot cleans a room with stairs at one end. The new carpet is nearly black and reflects little infrared."""

import math
from pathlib import Path

import pytest
import yaml

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Pose2D = message_type("geometry_msgs/msg/Pose2D")
UInt16 = message_type("std_msgs/msg/UInt16")

DT = 0.1
LENGTH, WIDTH = 2.8, 1.7  # m; walls on three sides, stairs behind the fourth
BODY = 0.16  # m, radius
BEIGE, BLACK = 420.0, 120.0  # what the cliff sensor reads above the carpet


class Room:
    """A room with a carpet in its middle; `carpet` is what the cliff sensor reads above it."""

    def __init__(self, rng, carpet):
        self.rng = rng
        self.carpet = carpet * rng.uniform(0.85, 1.15)
        self.oak = float(rng.uniform(560.0, 700.0))
        self.stairs = float(rng.uniform(10.0, 28.0))
        self.rug = (
            rng.uniform(0.8, 1.0),
            rng.uniform(1.8, 2.1),
            rng.uniform(0.3, 0.5),
            rng.uniform(1.2, 1.4),
        )
        self.x, self.y, self.heading = 0.25, 0.2, float(rng.normal(0.0, 0.04))
        self.bump = False
        self.volts = float(rng.uniform(14.2, 15.0))
        self.clean = set()
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def cells(self):
        """Return the number of cells, of 0.1 m, that the brush can reach."""
        return round((LENGTH - 2 * BODY) / 0.1) * round((WIDTH - 2 * BODY) / 0.1)

    @property
    def share(self):
        """Return the share of the room that is clean."""
        return min(1.0, len(self.clean) / self.cells)

    @property
    def done(self):
        """Return whether the robot has finished, or something went wrong."""
        return bool(self.failure) or self.over

    def below(self):
        """Return what the cliff sensor sees, 0.15 m ahead of the middle."""
        x = self.x + 0.15 * math.cos(self.heading)
        y = self.y + 0.15 * math.sin(self.heading)
        if x > LENGTH:
            return self.stairs
        left, right, low, high = self.rug
        return self.carpet if left < x < right and low < y < high else self.oak

    def publish(self, bus):
        """Publish the pose and the sensors."""
        bus.publish("odom/pose", Pose2D(x=self.x, y=self.y, theta=self.heading + self.rng.normal(0.0, 0.005)))
        bus.publish("bumper", Bool(data=self.bump))
        raw = self.below() + self.rng.normal(0.0, 4.0)
        bus.publish("cliff/front", UInt16(data=max(0, round(raw))))
        bus.publish("dirt/counts", UInt16(data=int(self.rng.poisson(15.0))))
        if round(self.time / DT) % 20 == 0:
            bus.publish("battery/volts", Float32(data=self.volts + self.rng.normal(0.0, 0.05)))

    def advance(self, cmd, finished):
        """Drive for one step."""
        speed, turn = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        self.heading += DT * turn
        x = self.x + DT * speed * math.cos(self.heading)
        y = self.y + DT * speed * math.sin(self.heading)
        self.x = max(BODY, x)
        self.y = max(BODY, min(WIDTH - BODY, y))
        self.bump = abs(self.x - x) + abs(self.y - y) > 1e-9
        self.time += DT
        before = len(self.clean)
        for side in (-0.15, -0.1, -0.05, 0.0, 0.05, 0.1, 0.15):
            a = self.x - side * math.sin(self.heading)
            b = self.y + side * math.cos(self.heading)
            if BODY < a < LENGTH - BODY and BODY < b < WIDTH - BODY:
                self.clean.add((round(a, 1), round(b, 1)))
        self.gained = 0.02 * (len(self.clean) - before) - 0.002
        self.over = bool(finished and finished.data)
        if self.x > LENGTH:
            self.failure = "robot falls down the stairs"
            self.gained -= 10.0
        elif self.time > 150.0:
            self.failure = "robot is still in the room"
            self.gained -= 4.0
        elif self.over and self.share < 0.85:
            self.failure = f"{100 * self.share:.0f} % of the room is clean"
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["carpet_vacuum.py"],
    sensors=[
        Sensor("floor", topic="cliff/front", field="data", low=0.0, high=750.0, bins=6),
        Sensor("x", topic="odom/pose", field="x", low=0.0, high=2.9, bins=3, unit="m"),
        Sensor("y", topic="odom/pose", field="y", low=0.0, high=1.7, bins=2, unit="m"),
    ],
    drifts={"black carpet": BLACK},
    episodes=200,
    min_success=0.97,
)
def test_cleans(tarl, tarl_drift):
    """Clean the room once."""
    room = Room(tarl.rng("room"), tarl_drift or BEIGE)
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("carpet_vacuum.py", parameters=config["carpet_vacuum"]["ros__parameters"])
    while not room.done:
        room.publish(tarl.bus)
        tarl.step(DT)
        room.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("vacuum/finished"))
        tarl.reward(room.gained)
    assert not room.failure, room.failure
