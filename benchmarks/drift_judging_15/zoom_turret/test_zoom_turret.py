"""A camera follows a bird. The operator has zoomed in on a far one; the node shows the zoom and does not use it."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
JointState = message_type("sensor_msgs/JointState")
PointStamped = message_type("geometry_msgs/PointStamped")

DT = 0.1
STEPS = 120
LATE = 2  # number of steps from the camera to the tracker
SCALE = 1280 / math.radians(52.0)  # scale of the wide picture (px/rad)
WIDE, NEAR = 1.0, 6.5


class Sky:
    """A bird that circles; `zoom` is that of the lens."""

    def __init__(self, rng, zoom):
        self.rng = rng
        self.zoom = zoom * (1.0 + 0.04 * rng.normal())
        self.fast = rng.uniform(0.85, 1.0) * (1.0 if zoom < 2.0 else 0.2)  # rad/s; distant birds seem slow
        self.wide, self.phase = rng.uniform(0.25, 0.4), rng.uniform(0.0, 2 * math.pi)
        self.now = 0
        self.head, self.rates = list(self.bird()), [0.0, 0.0]
        self.seen = [(640.0, 360.0)] * (LATE + 1)
        self.gained, self.outside = 0.0, 0

    def bird(self):
        """Return the bird's bearing and height in rad."""
        turn = self.phase + self.fast * self.now * DT
        return self.wide * math.sin(turn), 0.4 + 0.35 * self.wide * math.cos(1.4 * turn)

    def publish(self, bus):
        """Publish an old picture's target, the joints and the zoom."""
        target = PointStamped()
        target.point.x, target.point.y = self.seen[-1 - LATE]
        if 0.0 <= target.point.x <= 1280.0 and 0.0 <= target.point.y <= 720.0:
            bus.publish("tracker/target", target)
        bus.publish("head/joints", JointState(position=[float(one) for one in self.head]))
        bus.publish("camera/zoom", Float32(data=self.zoom))

    def advance(self, command):
        """Turn the head for one step and take the next picture."""
        wanted = (command.angular.z, command.angular.y) if command else (0.0, 0.0)
        self.now += 1
        off = []
        for axis, bird in enumerate(self.bird()):
            self.rates[axis] += 0.7 * (wanted[axis] - self.rates[axis])
            self.head[axis] += DT * (self.rates[axis] + self.rng.normal(0.0, 0.01))
            off.append((bird - self.head[axis]) * SCALE * self.zoom)
        x = 640.0 + off[0] + self.rng.normal(0.0, 2.0)
        y = 360.0 - off[1] + self.rng.normal(0.0, 2.0)
        self.seen.append((float(x), float(y)))
        out = abs(off[0]) > 430.0 or abs(off[1]) > 250.0
        self.outside += out
        self.gained = 0.1 * (1.0 - 0.2 * min(1.0, math.hypot(*off) / 500.0)) - 0.15 * out


@pytest.mark.tarl(
    nodes=["zoom_turret.py"],
    sensors=[
        Sensor("right", topic="tracker/target", field="point.x", low=0.0, high=1280.0, bins=4, unit="px"),
        Sensor("down", topic="tracker/target", field="point.y", low=0.0, high=720.0, bins=4, unit="px"),
        Sensor("zoom", topic="camera/zoom", field="data", low=1.0, high=8.0, bins=7),
    ],
    drifts={"zoomed in": NEAR},
    episodes=200,
    min_success=0.97,
)
def test_follows(tarl, tarl_drift):
    """Follow a bird for twelve seconds."""
    sky = Sky(tarl.rng("sky"), tarl_drift or WIDE)
    tarl.start("zoom_turret.py")
    for _ in range(STEPS):
        sky.publish(tarl.bus)
        tarl.step(DT)
        sky.advance(tarl.bus.latest("head/rates"))
        tarl.reward(sky.gained)
    assert sky.outside <= 4, f"bird out of the picture's middle for {sky.outside} steps"
