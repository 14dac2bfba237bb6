"""A capper screws caps on bottles. The new caps are taller, and their thread has more turns."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.02
LOW_CAP, TALL_CAP = 1.5, 2.75  # turns until the cap is seated
BOTTLES = 4


class Line:
    """Four bottles whose caps have a thread of `thread` turns; a few threads are stripped."""

    def __init__(self, rng, thread):
        self.rng = rng
        self.thread = thread
        self.left = BOTTLES
        self.time, self.gained, self.failure = 0.0, 0.0, ""
        self.rpm, self.load, self.pause = 0.0, 0.0, 0
        self.next_bottle()

    @property
    def done(self):
        """Return whether all bottles have passed, or something went wrong."""
        return bool(self.failure) or self.left == 0

    def next_bottle(self):
        """Bring the next bottle."""
        self.seat = self.thread + self.rng.uniform(-0.15, 0.15)
        self.stripped = self.rng.random() < 0.06
        self.turns, self.most, self.spun = 0.0, 0.0, 0.0
        self.pause = 15

    @property
    def torque(self):
        """Return the torque of the cap, in Nm."""
        over = max(0.0, self.turns - self.seat)
        return 0.08 * (self.rpm > 1.0) + (min(0.25, 4.0 * over) if self.stripped else 4.0 * over)

    def publish(self, bus):
        """Publish the bottle, the spindle and the head."""
        bus.publish("bottle/present", Bool(data=self.pause == 0))
        bus.publish("spindle/torque", Float32(data=self.torque + self.rng.normal(0.0, 0.02)))
        bus.publish("spindle/turns", Float32(data=self.turns))
        bus.publish("head/load", Float32(data=self.load + self.rng.normal(0.0, 0.5)))

    def advance(self, rpm, head, verdict):
        """Turn for one step; the verdict on a bottle lets it go."""
        self.load += 0.2 * ((head.data if head else 0.0) - self.load)
        self.rpm += 0.6 * ((rpm.data if rpm else 0.0) - self.rpm)
        self.time += DT
        self.gained = -0.0004
        if self.pause:
            self.pause -= 1
            return
        self.turns += DT * self.rpm / 60.0
        self.spun += DT * (self.rpm > 1.0)
        self.most = max(self.most, self.torque)
        if verdict and verdict.data:
            self.judge(verdict.data)
        if self.stripped and self.turns > 6.0:
            self.failure = "spindle grinds plastic off a stripped cap"
        elif self.time > 30.0:
            self.failure = "line stands still"
        if self.failure:
            self.gained -= 4.0

    def judge(self, verdict):
        """Judge a bottle."""
        self.left -= 1
        if self.stripped:
            if verdict == "good":
                self.failure = "bottle with a stripped cap is passed"
            else:
                self.gained += 1.2 - 0.1 * max(0.0, self.turns - 4.0)
        elif verdict != "good":
            self.failure = f"sound bottle is rejected, {self.most:.2f} Nm"
        else:
            self.gained += 1.5 * max(-1.0, 1.0 - ((self.most - 1.45) / 0.5) ** 2)
            if self.most > 2.0:
                self.failure = "cap bursts"
        if self.left:
            self.next_bottle()


@pytest.mark.tarl(
    nodes=["bottle_capper.py"],
    sensors=[
        Sensor("turns", topic="spindle/turns", field="data", low=0.0, high=4.0, bins=6),
        Sensor("torque", topic="spindle/torque", field="data", low=0.0, high=1.8, bins=4, unit="Nm"),
    ],
    drifts={"tall caps": TALL_CAP},
    episodes=200,
    min_success=0.97,
)
def test_caps(tarl, tarl_drift):
    """Cap four bottles."""
    line = Line(tarl.rng("line"), tarl_drift or LOW_CAP)
    tarl.start("bottle_capper.py")
    while not line.done:
        line.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        line.advance(bus.latest("spindle/rpm"), bus.latest("head/force"), bus.latest("capper/verdict"))
        tarl.reward(line.gained)
    assert not line.failure, line.failure
