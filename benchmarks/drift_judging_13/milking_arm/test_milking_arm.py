"""A milking robot attaches four cups. A cow has kicked its camera, which now looks up more steeply."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
PointStamped = message_type("geometry_msgs/msg/PointStamped")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.1
ASIDE, ALONG = 0.024, 0.03  # maximum distance of the cup from the teat (m)
TIME_BOUND = 40.0
STRAIGHT, KICKED = 0.35, 0.47  # rad


class Cow:
    """A cow in a box, an arm below her, and a camera that looks up by `pitch` radians."""

    def __init__(self, rng, pitch):
        self.rng = rng
        self.pitch = pitch + rng.uniform(-0.008, 0.008)
        x, z = rng.uniform(0.52, 0.60), rng.uniform(0.50, 0.58)
        self.teats = [
            (x + dx + rng.uniform(-0.01, 0.01), dy + rng.uniform(-0.01, 0.01), z + rng.uniform(-0.015, 0.015))
            for dx in (0.0, 0.12)
            for dy in (-0.06, 0.06)
        ]
        self.sway = [0.0, 0.0]
        self.tool = [0.2, 0.0, 0.1]
        self.attached, self.missed = 0, 0
        self.sucks = 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all cups hold, or the robot has given up."""
        return bool(self.failure) or self.attached == len(self.teats)

    def teat(self):
        """Return the position of the next teat."""
        x, y, z = self.teats[self.attached]
        return x + self.sway[0], y + self.sway[1], z

    def publish(self, bus):
        """Publish what the camera sees, the position of the tool and how many cups hold."""
        x, y, z = self.teat()
        ahead, up = x - 0.06, z - 0.24
        c, s = math.cos(self.pitch), math.sin(self.pitch)
        seen = PointStamped()
        seen.point.x = -y + self.rng.normal(0.0, 0.002)
        seen.point.y = -(up * c - ahead * s) + self.rng.normal(0.0, 0.002)
        seen.point.z = ahead * c + up * s + self.rng.normal(0.0, 0.003)
        bus.publish("camera/teat", seen)
        tool = PointStamped()
        tool.point.x, tool.point.y, tool.point.z = self.tool
        bus.publish("arm/tool", tool)
        bus.publish("cup/attached", UInt8(data=self.attached))
        bus.publish("milk/flow", Float32(data=0.4 * self.attached + abs(self.rng.normal(0.0, 0.02))))

    def advance(self, target, vacuum):
        """Move arm and cow for one step; a cup that sucks takes hold of a teat in reach."""
        if target is not None:
            wanted = (target.point.x, target.point.y, target.point.z)
            for axis, value in enumerate(wanted):
                step = (value - self.tool[axis]) * (1.0 - math.exp(-DT / 0.2))
                self.tool[axis] += max(-0.05, min(0.05, step))
        self.sway = [0.97 * one + self.rng.normal(0.0, 0.0009) for one in self.sway]
        self.time += DT
        self.gained = -0.003
        self.sucks = self.sucks + DT if vacuum is not None and vacuum.data else 0.0
        if self.sucks > 0.25:
            self._hold()

    def _hold(self):
        x, y, z = self.teat()
        aside = math.hypot(self.tool[0] - x, self.tool[1] - y)
        if aside < ASIDE and abs(self.tool[2] - z) < ALONG:
            self.attached += 1
            self.sucks = 0.0
            self.gained += 2.6 * (1.0 - 0.3 * (aside / ASIDE) ** 2)
        elif self.sucks > 2.0:
            self.failure = f"cup {self.attached + 1} sucks air"

    def judge(self):
        """Return the reward of the step: cups that hold."""
        if self.time > TIME_BOUND:
            self.failure = "the cow has to wait"
        return self.gained - (3.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["milking_arm.py", "camera_frame.py"],
    sensors=[
        Sensor("depth", topic="camera/teat", field="point.z", low=0.4, high=0.8, bins=4, unit="m"),
        Sensor("height", topic="arm/tool", field="point.z", low=0.0, high=0.7, bins=5, unit="m"),
        Sensor("cups", topic="cup/attached", field="data"),
    ],
    drifts={"kicked camera": Drift(KICKED, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_attaches(tarl, tarl_drift):
    """Milk one cow."""
    cow = Cow(tarl.rng("cow"), tarl_drift or STRAIGHT)
    tarl.start("milking_arm.py")
    while not cow.done:
        cow.publish(tarl.bus)
        tarl.step(DT)
        cow.advance(tarl.bus.latest("arm/target"), tarl.bus.latest("cup/vacuum"))
        tarl.reward(cow.judge())
    assert not cow.failure, cow.failure
