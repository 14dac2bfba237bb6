"""A cart follows a tape to a cross mark.

In the glazed corridor the sun raises the readings of all eyes of the cart.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
UInt16MultiArray = message_type("std_msgs/msg/UInt16MultiArray")

DT = 0.1
EYES = 7
PITCH = 0.02
LENGTH = 4.0


class Floor:
    """A curved tape below seven eyes."""

    def __init__(self, rng, sun):
        self.rng = rng
        self.sun = sun + (rng.uniform(-15.0, 15.0) if sun else 0.0)
        self.bend, self.phase = rng.uniform(0.06, 0.12), rng.uniform(0.0, 6.28)
        self.x, self.heading = 0.0, 0.0
        self.y = self.tape(0.0) + rng.uniform(-0.01, 0.01)
        self.heading = math.atan(self.bend * 1.6 * math.cos(self.phase))
        self.time, self.failure, self.arrived = 0.0, "", False

    def tape(self, x):
        """Return the lateral position of the tape at x, in m."""
        return self.bend * math.sin(1.6 * x + self.phase)

    @property
    def done(self):
        """Return whether the ride is over."""
        return self.arrived or bool(self.failure)

    def publish(self, bus):
        """Publish the eyes and the light sensor on the lid."""
        off = self.y - self.tape(self.x)
        cross = self.x >= LENGTH
        read = []
        for eye in range(EYES):
            at = off + ((EYES - 1) / 2 - eye) * PITCH
            black = cross or abs(at) < 0.019
            read.append(int((180.0 if black else 640.0) + self.sun + self.rng.normal(0.0, 25.0)))
        bus.publish("lid_light", Float32(data=self.sun * 40.0 + 300.0 + self.rng.normal(0.0, 20.0)))
        bus.publish("line_eyes", UInt16MultiArray(data=read))

    def advance(self, cmd, arrived):
        """Drive one step and return its reward."""
        self.time += DT
        if arrived and arrived.data:
            self.arrived = True
            if self.x < LENGTH - 0.05:
                self.failure = "stopped before the mark"
                return -4.0
            return 3.0
        if cmd is None:
            return 0.0
        before = self.x
        self.heading += cmd.angular.z * DT
        self.x += cmd.linear.x * math.cos(self.heading) * DT
        self.y += cmd.linear.x * math.sin(self.heading) * DT
        off = abs(self.y - self.tape(self.x))
        if off > 0.3 or self.x > LENGTH + 0.4:
            self.failure = "lost the tape"
        elif self.time > 17.0:
            self.failure = "late"
        if self.failure:
            return -4.0
        return 7.0 * (self.x - before) / LENGTH * (1.0 - min(1.0, off / 0.15))


@pytest.mark.tarl(
    nodes=["tape_cart.py"],
    sensors=[
        Sensor("light", topic="lid_light", field="data", edges=(4000.0,), unit="lx"),
        Sensor("middle", topic="line_eyes", field="data.3", low=0, high=1000, bins=5),
    ],
    drifts={"sunlight": 400.0},
    episodes=100,
    min_success=0.95,
)
def test_arrives(tarl, tarl_drift):
    """Bring the linen to the mark."""
    floor = Floor(tarl.rng("floor"), tarl_drift or 0.0)
    tarl.start("tape_cart.py")
    while not floor.done:
        floor.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(floor.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("arrived")))
    assert not floor.failure, floor.failure
