"""The camera keeps its target near the middle of the image for four seconds."""

import math
from collections import deque

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.05
DURATION = 5.0
VIEW = 0.35  # half of the field of view, rad
PIXEL = 0.0016


class Scene:
    """A target that moves around the camera; images arrive `late` steps after they are taken."""

    def __init__(self, rng, late):
        self.rng = rng
        self.swing, self.pace = rng.uniform(0.35, 0.5), rng.uniform(0.5, 0.6)
        self.phase = rng.uniform(0.0, 2 * math.pi)
        self.time = 0.0
        self.pan, self.rate = self.bearing + rng.uniform(-0.15, 0.15), 0.0
        self.images = deque([self.pixels] * (late + 1), maxlen=late + 1)
        self.failure = ""

    @property
    def bearing(self):
        """Return the direction of the target, rad."""
        return self.swing * math.sin(self.pace * self.time + self.phase)

    @property
    def pixels(self):
        """Return the position of the target in the image taken now."""
        return 320.0 + (self.bearing - self.pan) / PIXEL

    @property
    def done(self):
        """Return whether the scene is over."""
        return self.time >= DURATION

    def publish(self, bus):
        """Publish the detection in the latest image that has arrived."""
        seen = PointStamped()
        seen.point.x = self.images[0] + self.rng.normal(0.0, 1.0)
        seen.point.z = self.rng.uniform(0.5, 1.0)
        bus.publish("/target", seen)

    def advance(self, command):
        """Pan for one step."""
        wanted = command.data if command else 0.0
        self.rate += (wanted - self.rate) * 0.7
        self.pan += self.rate * DT
        self.time += DT
        self.images.append(self.pixels)

    def judge(self):
        """Return the reward of the step, which is larger near the middle of the image."""
        off = abs(self.bearing - self.pan) / VIEW
        if off > 1.0:
            self.failure = "lost the target"
        return -10.0 if self.failure else 0.1 * (1.0 - off**2)


@pytest.mark.tarl(
    nodes=["tracker.py"],
    sensors=[Sensor("seen", topic="/target", field="point.x", low=100, high=540, bins=11, unit="px")],
    drifts={"slow network": 7},
    episodes=100,
    min_success=0.95,
)
def test_keeps_the_target(tarl, tarl_drift):
    """Keep the target in view."""
    scene = Scene(tarl.rng("scene"), tarl_drift or 1)
    tarl.start("tracker.py")
    while not (scene.done or scene.failure):
        scene.publish(tarl.bus)
        tarl.step(DT)
        scene.advance(tarl.bus.latest("/pan_rate"))
        tarl.reward(scene.judge())
    assert not scene.failure, scene.failure
