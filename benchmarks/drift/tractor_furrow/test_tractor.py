"""The tractor stays in its furrow and reaches the headland in time, even with a heavy implement."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Float32MultiArray = message_type("std_msgs/msg/Float32MultiArray")

DT = 0.1
LENGTH = 14.0
TIME_BOUND = 14.5
HALF_WIDTH = 0.3


class Field:
    """A winding furrow. A heavy implement reduces steering and pull to the share `grip`."""

    def __init__(self, rng, grip):
        self.rng = rng
        self.grip = grip
        self.swing, self.phase = rng.uniform(0.5, 0.6), rng.uniform(0.0, 6.28)
        self.x, self.y = 0.0, self.furrow(0.0) + rng.uniform(-0.05, 0.05)
        self.heading = self.direction(0.0)
        self.speed, self.depth, self.time = 0.0, 0.1, 0.0
        self.gained = 0.0
        self.failure = ""

    def furrow(self, x):
        """Return the lateral position of the furrow, m."""
        return self.swing * math.sin(0.8 * x + self.phase)

    def direction(self, x):
        """Return the direction of the furrow, rad."""
        return math.atan(0.8 * self.swing * math.cos(0.8 * x + self.phase))

    def publish(self, bus):
        """Publish the measurements of camera, wheels and hitch."""
        ahead = self.x + 0.3
        offset = self.furrow(ahead) - (self.y + 0.3 * math.tan(self.heading)) + self.rng.normal(0.0, 0.005)
        angle = self.direction(ahead) - self.heading + self.rng.normal(0.0, 0.01)
        bus.publish("/draught", Float32(data=4.0 / self.grip + self.rng.normal(0.0, 0.3)))
        bus.publish("/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.02)))
        bus.publish("/depth", Float32(data=self.depth))
        bus.publish("/furrow", Float32MultiArray(data=[offset, angle, self.rng.uniform(0.5, 1.0)]))

    def advance(self, drive, hitch):
        """Drive for one step."""
        throttle, wheels = (drive.linear.x, drive.angular.z) if drive else (0.0, 0.0)
        turn = self.speed * math.tan(max(-0.9, min(0.9, wheels))) / 0.9
        pull = 2.4 * max(0.0, min(1.0, throttle)) * self.grip
        self.speed += (pull - self.speed) * 0.25
        self.heading += turn * self.grip * DT
        self.gained = self.speed * math.cos(self.heading) * DT
        self.x += self.gained
        self.y += self.speed * math.sin(self.heading) * DT
        self.depth += ((hitch.data if hitch else 0.5) - 0.5) * 0.05
        self.time += DT

    def judge(self):
        """Return the reward of the step: progress minus a penalty for the distance from the furrow."""
        off = abs(self.y - self.furrow(self.x)) / HALF_WIDTH
        if off > 1.0:
            self.failure = "left the furrow"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return 10.0 * self.gained / LENGTH - 0.005 * off - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["tractor.py", "guidance.py", "powertrain.py"],
    sensors=[
        Sensor("draught", topic="/draught", field="data", low=2, high=14, bins=12, unit="kN"),
        Sensor("speed", topic="/speed", field="data", low=0, high=2.4, bins=6, unit="m/s"),
    ],
    drifts={"heavy implement": 0.5},
    episodes=100,
    min_success=0.95,
)
def test_follows_the_furrow(tarl, tarl_drift):
    """Get to the headland."""
    field = Field(tarl.rng("field"), tarl_drift or 1.0)
    tarl.start("tractor.py")
    while field.x < LENGTH and not field.failure:
        field.publish(tarl.bus)
        tarl.step(DT)
        field.advance(tarl.bus.latest("/drive"), tarl.bus.latest("/hitch"))
        tarl.reward(field.judge())
    assert not field.failure, field.failure
