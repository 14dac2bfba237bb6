"""A plough clears the lanes of a helipad. In deep snow its tracks slip, ahead and even more in turns."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
JointState = message_type("sensor_msgs/msg/JointState")

DT = 0.2
TICK = 0.002
TRACK = 0.95
CORNERS = [(7.0, 0.0), (7.0, 5.0), (0.5, 5.0), (0.5, 10.0), (7.0, 10.0)]
NEAR = 1.2  # half the width of the blade (m)
TIME_BOUND = 150.0
STANDS = 4.0  # s


class Pad:
    """A tracked plough on a pad; `ahead` and `turning` are the shares of the tracks' motion that are left."""

    def __init__(self, rng, snow, ahead, turning):
        self.rng = rng
        self.snow = snow * rng.uniform(0.9, 1.1)
        self.ahead = ahead * rng.uniform(0.99, 1.01)
        self.turning = turning * rng.uniform(0.99, 1.01)
        self.x, self.y, self.yaw = 0.0, 0.0, 0.0
        self.ticks = [0.0, 0.0]
        self.next = 0
        self.time, self.stood, self.gained = 0.0, 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the plough has finished, or is lost."""
        return bool(self.failure) or self.next >= len(CORNERS)

    def publish(self, bus):
        """Publish the ticks of the tracks and the depth of the snow."""
        bus.publish("tracks", JointState(name=["left", "right"], position=[round(t) for t in self.ticks]))
        bus.publish("snow/depth", Float32(data=max(0.0, self.snow + self.rng.normal(0.0, 0.005))))

    def advance(self, cmd):
        """Drive for one step."""
        v, w = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        left, right = (v - w * TRACK / 2) * DT, (v + w * TRACK / 2) * DT
        self.ticks[0] += left / TICK
        self.ticks[1] += right / TICK
        forward = (left + right) / 2 * self.ahead * self.rng.uniform(0.97, 1.03)
        turned = (right - left) / TRACK * self.turning * self.rng.uniform(0.97, 1.03)
        self.x += forward * math.cos(self.yaw + turned / 2)
        self.y += forward * math.sin(self.yaw + turned / 2)
        self.yaw += turned
        self.time += DT
        self.stood = self.stood + DT if v == 0.0 and w == 0.0 else 0.0
        self.gained = 0.0
        if math.dist((self.x, self.y), CORNERS[self.next]) < NEAR:
            self.next += 1
            self.gained = 10.0 / len(CORNERS)

    def judge(self):
        """Return the reward of the step: lanes that are cleared to their ends."""
        if not self.done:
            if self.stood > STANDS:
                self.failure = "stops before the last lane is clear"
            elif self.time > TIME_BOUND:
                self.failure = "late"
            elif not (-3.0 < self.x < 10.0 and -3.0 < self.y < 13.0):
                self.failure = "leaves the pad"
        return self.gained - 0.0005 - (2.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["helipad_plough.py"],
    sensors=[
        Sensor("snow", topic="snow/depth", field="data", low=0.0, high=0.4, bins=4, unit="m"),
    ],
    drifts={"deep snow": {"snow": 0.25, "ahead": 0.78, "turning": 0.65}},
    episodes=200,
    min_success=0.97,
)
def test_clears_the_pad(tarl, tarl_drift):
    """Clear the pad once."""
    drift = tarl_drift or {"snow": 0.04, "ahead": 1.0, "turning": 1.0}
    pad = Pad(tarl.rng("pad"), **drift)
    tarl.start("helipad_plough.py")
    while not pad.done:
        pad.publish(tarl.bus)
        tarl.step(DT)
        pad.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(pad.judge())
    assert not pad.failure, pad.failure
