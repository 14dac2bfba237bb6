"""A person drives the donkey car by radio. The node reads the receiver's pulse widths; a new radio sends others."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

UInt16 = message_type("std_msgs/UInt16")

NODE = "donkey_car/src/rc_arduino_2_twist.py"
DT = 0.1
LENGTH = 12.0  # of the lane, m
HALF = 0.5  # half of its width, m
TIME_BOUND = 12.0


class Lane:
    """A straight lane; the radio sends pulses of 1500 ± `swing` µs, with the steering off by `trim` µs."""

    def __init__(self, rng, swing=600.0, trim=0.0):
        self.rng = rng
        self.swing, self.trim = swing, trim
        self.x, self.y = 0.0, rng.uniform(-0.2, 0.2)
        self.heading = rng.uniform(-0.1, 0.1)
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the pulses of both sticks, as the driver holds them."""
        steering = max(-1.0, min(1.0, -0.5 * self.y - 0.8 * self.heading))
        for topic, stick, trim in (("/rc_throttle", 0.8, 0.0), ("/rc_steering", steering, self.trim)):
            width = 1500.0 + self.swing * stick + trim + self.rng.normal(0.0, 2.0)
            bus.publish(topic, UInt16(data=round(width)))

    def advance(self, cmd):
        """Drive for one step."""
        throttle, steering = (cmd.linear.x, cmd.angular.z) if cmd else (0.0, 0.0)
        speed = 1.7 * throttle
        self.heading += 1.5 * steering * DT + self.rng.normal(0.0, 0.01)
        self.y += speed * math.sin(self.heading) * DT
        self.gained = speed * math.cos(self.heading) * DT
        self.x += self.gained
        self.time += DT

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.x > LENGTH

    def judge(self):
        """Return the reward of the step: for progress near the middle of the lane."""
        if abs(self.y) > HALF:
            self.failure = "off the lane"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return (-5.0 if self.failure else 0.0) + 0.8 * self.gained * (1.0 - abs(self.y) / HALF)


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("steering", topic="/rc_steering", field="data", low=1200, high=1800, bins=6, unit="µs"),
    ],
    drifts={
        "new radio": Drift({"swing": 400.0}, permanent=True),
        "trim": Drift({"trim": 150.0}, permanent=True),
    },
    episodes=40,
    min_success=0.95,
)
def test_drives_along_the_lane(tarl, tarl_drift):
    """Drive."""
    lane = Lane(tarl.rng("lane"), **(tarl_drift or {}))
    tarl.start(NODE)
    while not lane.over:
        lane.publish(tarl.bus)
        tarl.step(DT)
        lane.advance(tarl.bus.latest("/cmd_vel"))
        tarl.reward(lane.judge())
    assert not lane.failure, lane.failure
