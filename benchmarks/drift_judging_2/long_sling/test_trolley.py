"""The load hangs still when it is lowered. Beams hang in longer slings than boxes and swing more slowly."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float64 = message_type("std_msgs/msg/Float64")
String = message_type("std_msgs/msg/String")

DT = 0.1
STILL = 0.17  # maximum sway of a load when it is lowered, m
PLACE = 0.15  # maximum distance from the goal, m
TIME_BOUND = 30.0


class Hall:
    """A crane; `sling` is the distance from the hook to the middle of the load, m."""

    def __init__(self, rng, sling):
        self.rng = rng
        self.load = "box" if sling < 2.0 else "beam"
        self.hoist = rng.uniform(1.5, 2.5)
        self.length = self.hoist + sling * rng.uniform(0.98, 1.02)
        self.x, self.speed = rng.uniform(0.0, 1.0), 0.0
        self.goal = self.x + rng.uniform(3.0, 6.0)
        self.angle, self.rate = 0.0, 0.0
        self.gained = 0.0
        self.time = 0.0
        self.lowered = False
        self.failure = ""

    @property
    def sway(self):
        """Return the amplitude of the swinging load, m."""
        return self.length * math.hypot(self.angle, self.rate * math.sqrt(self.length / 9.81))

    def publish(self, bus):
        """Publish job, kind of load and encoders."""
        bus.publish("load/kind", String(data=self.load))
        bus.publish("hoist/length", Float64(data=self.hoist + self.rng.normal(0.0, 0.01)))
        bus.publish("trolley/position", Float64(data=self.x))
        bus.publish("goal", Float64(data=self.goal))

    def advance(self, speed, lower):
        """Move and swing for one step."""
        wanted = max(-1.0, min(1.0, speed.data)) if speed else 0.0
        before = self.x
        for _ in range(10):
            accel = (wanted - self.speed) / 0.3
            self.speed += accel * DT / 10
            self.x += self.speed * DT / 10
            pull = -9.81 * math.sin(self.angle) - accel * math.cos(self.angle)
            self.rate += (pull / self.length - 0.01 * self.rate) * DT / 10
            self.angle += self.rate * DT / 10
        self.gained = self.x - before
        self.time += DT
        self.lowered = bool(lower and lower.data)

    def judge(self):
        """Return the reward of the step: some for progress, most for a load that is set down well."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.lowered and self.sway > STILL:
            self.failure = f"the load swings by {self.sway:.2f} m"
        elif self.lowered and abs(self.x - self.goal) > PLACE:
            self.failure = f"{abs(self.x - self.goal):.2f} m away from the goal"
        if self.failure:
            return -6.0
        return 0.4 * self.gained + (8.0 - 3.0 * self.sway if self.lowered else 0.0)


@pytest.mark.tarl(
    nodes=["trolley.py", "shaper.py"],
    sensors=[
        Sensor("load", topic="load/kind", field="data", categories=("box", "beam")),
        Sensor("hoist", topic="hoist/length", field="data", low=1.5, high=2.5, bins=4, unit="m"),
    ],
    drifts={"beams": 5.0},
    episodes=100,
    min_success=0.95,
)
def test_sets_the_load_down(tarl, tarl_drift):
    """Move one load."""
    hall = Hall(tarl.rng("hall"), tarl_drift or 1.0)
    tarl.start("trolley.py")
    while not (hall.lowered or hall.failure):
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance(tarl.bus.latest("trolley/speed"), tarl.bus.latest("hoist/lower"))
        tarl.reward(hall.judge())
    assert not hall.failure, hall.failure
