"""VRX's boat follows a helmsman's commands along a channel. Weed fouls its left propeller."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Twist = message_type("geometry_msgs/Twist")

NODE = "vrx_gazebo/nodes/twist2thrust.py"
DT = 0.2
LENGTH = 40.0  # of the channel, m
HALF = 2.5  # half of its width, m
TIME_BOUND = 60.0


class Channel:
    """A straight channel; `left` is the thrust of the left propeller as a share of the right one's."""

    def __init__(self, rng, left):
        self.rng = rng
        self.left = left
        self.x, self.y = 0.0, rng.uniform(-1.0, 1.0)
        self.heading = rng.uniform(-0.2, 0.2)
        self.speed, self.turn = 0.0, 0.0
        self.wind = rng.uniform(-0.05, 0.05)  # m/s, from the side
        self.time = 0.0
        self.failure = ""

    def publish(self, bus):
        """Publish the command of the helmsman, who steers for the middle of the channel."""
        wanted = math.atan2(-self.y, 8.0)
        twist = Twist()
        twist.linear.x = 0.45
        twist.angular.z = max(-0.4, min(0.4, 0.5 * (wanted - self.heading) - 0.3 * self.turn))
        bus.publish("/cmd_vel", twist)

    def advance(self, left, right):
        """Drift for one step."""
        left = self.left * max(-1.0, min(1.0, left.data)) if left else 0.0
        right = max(-1.0, min(1.0, right.data)) if right else 0.0
        self.speed += DT * (1.0 * (left + right) - 0.6 * self.speed)
        self.turn += DT * (0.8 * (right - left) - 0.8 * self.turn + self.rng.normal(0.0, 0.02))
        self.heading += self.turn * DT
        self.y += (self.speed * math.sin(self.heading) + self.wind) * DT
        self.gained = self.speed * math.cos(self.heading) * DT
        self.x += self.gained
        self.time += DT

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.x > LENGTH

    def judge(self):
        """Return the reward of the step: for progress in the middle of the channel."""
        if abs(self.y) > HALF:
            self.failure = "aground"
        elif self.time > TIME_BOUND:
            self.failure = "late"
        return (-5.0 if self.failure else 0.0) + 0.25 * self.gained * (1.0 - abs(self.y) / HALF)


@pytest.mark.tarl(
    nodes=[NODE],
    sensors=[
        Sensor("turn", topic="/cmd_vel", field="angular.z", low=-0.4, high=0.4, bins=8),
    ],
    drifts={"weed": Drift(0.5, permanent=True)},
    episodes=40,
    min_success=0.95,
)
def test_follows_the_channel(tarl, tarl_drift):
    """Steer the boat through the channel."""
    channel = Channel(tarl.rng("channel"), tarl_drift or 1.0)
    tarl.start(NODE, argv=["--keyboard"])
    while not channel.over:
        channel.publish(tarl.bus)
        tarl.step(DT)
        channel.advance(tarl.bus.latest("/left_cmd"), tarl.bus.latest("/right_cmd"))
        tarl.reward(channel.judge())
    assert not channel.failure, channel.failure
