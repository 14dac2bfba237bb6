"""A tractor welds a joint that a laser sees ahead of the torch. The laser was moved further ahead, for good."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.2
START = 90.0  # place where the seam must begin (mm)
LENGTH = 340.0
BESIDE = 1.5  # distance from the joint at which the arc still melts it (mm)
MAY_SKIP = 20.0  # length of the seam (mm)
TIME_BOUND = 90.0


class Seam:
    """A wavy joint between two plates; the laser's line is `lead` mm ahead of the torch."""

    def __init__(self, rng, lead):
        self.rng = rng
        self.lead = lead + rng.normal(0.0, 0.5)
        self.waves = [
            (rng.uniform(5.0, 6.5), 2 * math.pi / rng.uniform(190.0, 230.0), rng.uniform(0.0, 6.28)),
            (rng.uniform(0.5, 0.8), 2 * math.pi / rng.uniform(90.0, 110.0), rng.uniform(0.0, 6.28)),
        ]
        self.s = 0.0
        self.slide = 0.0
        self.time = 0.0
        self.bad, self.good = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the seam has ended."""
        return bool(self.failure) or self.s >= LENGTH

    def joint(self, s):
        """Return the place of the joint across the seam, mm."""
        return sum(a * math.sin(k * s + p) for a, k, p in self.waves)

    def publish(self, bus):
        """Publish the joint at the laser, the distance travelled and the place of the slide."""
        bus.publish("tractor/travelled", Float32(data=self.s))
        bus.publish("slide/position", Float32(data=self.slide + self.rng.normal(0.0, 0.03)))
        seen = PointStamped()
        seen.point.x = self.s
        seen.point.y = self.joint(self.s + self.lead) + self.rng.normal(0.0, 0.1)
        seen.point.z = 0.1 if self.rng.random() < 0.03 else 0.9
        bus.publish("tracker/joint", seen)

    def advance(self, travel, slide, arc):
        """Weld for one step."""
        forward = max(0.0, travel.data * DT) if travel else 0.0
        self.s += forward
        self.slide += (slide.data * DT if slide else 0.0) * self.rng.uniform(0.97, 1.03)
        self.time += DT
        self.good = 0.0
        if self.s > START:
            melts = arc is not None and arc.data and abs(self.slide - self.joint(self.s)) < BESIDE
            if melts:
                self.good = forward
            else:
                self.bad += forward
        if self.bad > MAY_SKIP:
            self.failure = "the joint is not welded"
        elif self.time > TIME_BOUND:
            self.failure = "the tractor stands"

    def judge(self):
        """Return the reward of the step: millimetres that are welded."""
        return 10.0 * self.good / (LENGTH - START) - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["weld_tractor.py", "joint_memory.py"],
    sensors=[
        Sensor("travelled", topic="tractor/travelled", field="data", low=0.0, high=340.0, bins=8, unit="mm"),
        Sensor("joint", topic="tracker/joint", field="point.y", low=-8.0, high=8.0, bins=4, unit="mm"),
    ],
    drifts={"moved laser": Drift(80.0, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_welds(tarl, tarl_drift):
    """Weld one seam."""
    seam = Seam(tarl.rng("seam"), tarl_drift or 45.0)
    tarl.start("weld_tractor.py")
    while not seam.done:
        seam.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        seam.advance(latest("tractor/speed"), latest("slide/velocity"), latest("torch/arc"))
        tarl.reward(seam.judge())
    assert not seam.failure, seam.failure
