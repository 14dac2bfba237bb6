"""A puck comes to rest on its mark and is judged when it lies still. On carpet it slides less far."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Point = message_type("geometry_msgs/msg/Point")
String = message_type("std_msgs/msg/String")

DT = 0.02
TIME_BOUND = 8.0


class Floor:
    """A floor of some friction."""

    def __init__(self, rng, friction):
        self.rng = rng
        self.kind = "lino" if friction == 0.09 else "carpet"
        self.braking = friction * 9.81 * rng.uniform(0.97, 1.03)
        self.mark = rng.uniform(1.0, 2.0)
        self.aside = rng.uniform(-0.02, 0.02)
        self.x, self.speed, self.arm = 0.0, 0.0, 0.0
        self.pushed = False
        self.time = 0.0
        self.failure = ""

    @property
    def still(self):
        """Return whether the puck has been pushed and lies still."""
        return self.pushed and self.speed == 0.0

    def publish(self, bus):
        """Publish the camera's measurement until the arm moves."""
        bus.publish("/floor", String(data=self.kind))
        if self.arm == 0.0 and not self.pushed:
            bus.publish("/mark", Point(x=self.mark + self.rng.normal(0.0, 0.005), y=self.aside))

    def advance(self, arm):
        """Let the puck be pushed or slide for one step; the arm cannot pull it."""
        self.arm = max(0.0, min(3.0, arm.data)) if arm else 0.0
        self.speed = max(0.0, self.speed - self.braking * DT)
        if self.arm > self.speed:
            self.speed = self.arm
        if self.speed > 0.0:
            self.pushed = True
        self.x += self.speed * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step, which is 0 before the end."""
        beside = abs(self.x - self.mark)
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.still and beside > 0.35:
            self.failure = f"{beside:.2f} m away from the mark"
        if self.failure:
            return -10.0
        return 10.0 - 2.0 * beside if self.still else 0.0


@pytest.mark.tarl(
    nodes=["putter.py"],
    sensors=[
        Sensor("floor", topic="/floor", field="data", categories=("lino", "carpet")),
        Sensor("mark", topic="/mark", field="x", low=1, high=2, bins=4, unit="m"),
    ],
    drifts={"carpet": 0.22},
    episodes=100,
    min_success=0.95,
)
def test_comes_to_rest_on_the_mark(tarl, tarl_drift):
    """Push once."""
    floor = Floor(tarl.rng("floor"), tarl_drift or 0.09)
    tarl.start("putter.py")
    while not (floor.still or floor.failure):
        floor.publish(tarl.bus)
        tarl.step(DT)
        floor.advance(tarl.bus.latest("/arm"))
        tarl.reward(floor.judge())
    assert not floor.failure, floor.failure
