"""Cars are plugged in, or soon left to the attendant if the flap is closed. Low sun rarely misleads the camera."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
PointStamped = message_type("geometry_msgs/msg/PointStamped")
WrenchStamped = message_type("geometry_msgs/msg/WrenchStamped")

DT = 0.1
FITS = 0.0015  # maximum distance from the middle at which the connector drops in, m
CLOSED = 0.06  # share of cars with a closed flap
STIFFNESS = 2000.0  # N/m
TIME_BOUND = 40.0


class Bay:
    """A car in its bay; for a share `misled` of the cars, the camera sees the inlet at a wrong place."""

    def __init__(self, rng, misled):
        self.rng = rng
        self.sun = rng.uniform(5.0, 15.0) if misled > 0.0 else rng.uniform(30.0, 60.0)
        self.inlet = (rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1))
        off, way = rng.uniform(0.0, 0.0042), rng.uniform(0.0, 2.0 * math.pi)
        self.closed = bool(rng.random() < CLOSED)
        if not self.closed and rng.random() < misled:
            off = rng.uniform(0.0070, 0.0090)
        self.seen = (self.inlet[0] + off * math.cos(way), self.inlet[1] + off * math.sin(way))
        self.tool = [0.0, 0.0, -0.1]
        self.push = 0.0
        self.time = 0.0
        self.latched, self.called = False, False
        self.failure = ""

    def publish(self, bus):
        """Publish the sun, the camera's estimate, the tool and its force."""
        bus.publish("camera/sun_elevation", Float64(data=self.sun))
        seen, tool, wrench = PointStamped(), PointStamped(), WrenchStamped()
        seen.point.x, seen.point.y = (part + self.rng.normal(0.0, 0.0001) for part in self.seen)
        tool.point.x, tool.point.y, tool.point.z = self.tool
        wrench.wrench.force.z = max(0.0, self.push + self.rng.normal(0.0, 0.3))
        bus.publish("camera/inlet", seen)
        bus.publish("arm/tool", tool)
        bus.publish("arm/wrench", wrench)

    def advance(self, command, state, latched):
        """Move the tool for one step; the side of the car is at 0, and the inlet is a hole in it."""
        if command:
            deep = self.tool[2] > 0.002
            wanted = (command.point.x, command.point.y, command.point.z)
            moves = [(to - at) * 0.8 for to, at in zip(wanted, self.tool, strict=True)]
            long = math.hypot(*moves)
            share = min(1.0, 0.08 * DT / long) if long > 0.0 else 0.0
            self.tool = [at + share * move for at, move in zip(self.tool, moves, strict=True)]
            inside = math.dist(self.tool[:2], self.inlet) < (0.004 if deep else FITS) and not self.closed
            if not inside:
                self.tool[2] = min(0.0, self.tool[2])
            self.push = STIFFNESS * max(0.0, wanted[2] - self.tool[2])
        self.latched = bool(latched and latched.data) and self.tool[2] > 0.015
        self.called = bool(state and state.data == "CALL")
        self.time += DT

    @property
    def done(self):
        """Return whether the job has ended."""
        return self.latched or self.called or bool(self.failure)

    def judge(self):
        """Return the reward of the step: time costs, a good end is rewarded."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.called and not self.closed:
            self.failure = "the attendant was called to an open inlet"
        elif self.latched or self.called:
            return 10.0
        return -6.0 if self.failure else -0.005


@pytest.mark.tarl(
    nodes=["plugger.py"],
    sensors=[
        Sensor("sun", topic="camera/sun_elevation", field="data", edges=(20.0,), unit="deg"),
        Sensor("force", topic="arm/wrench", field="wrench.force.z", low=0, high=20, bins=2, unit="N"),
        Sensor("depth", topic="arm/tool", field="point.z", low=-0.1, high=0.02, bins=3, unit="m"),
    ],
    drifts={"low sun": 0.11},
    episodes=100,
    min_success=0.95,
)
def test_plugs_in(tarl, tarl_drift):
    """Serve one car."""
    bay = Bay(tarl.rng("bay"), tarl_drift or 0.0)
    tarl.start("plugger.py")
    while not bay.done:
        bay.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        bay.advance(latest("arm/command"), latest("plugger/state"), latest("plugger/latched"))
        tarl.reward(bay.judge())
    assert not bay.failure, bay.failure
