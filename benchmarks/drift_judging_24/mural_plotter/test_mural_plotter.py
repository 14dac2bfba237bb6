"""A pen on two cords draws on a wall. It moves to a wall where the anchors are farther apart, for good."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Point = message_type("geometry_msgs/Point")
Vector3 = message_type("geometry_msgs/Vector3")

DT = 0.1
STUDIO = {"anchors": 2.4}
SCHOOL = {"anchors": 2.9}  # m


class Wall:
    """A wall whose `anchors` have some distance, in m."""

    def __init__(self, rng, anchors):
        self.rng = rng
        self.anchors = anchors + rng.normal(0.0, 0.003)
        middle = 0.5 * anchors
        self.left = math.hypot(middle, 1.0)
        self.right = math.hypot(self.anchors - middle, 1.0)
        x, y, radius = middle + float(rng.uniform(-0.25, 0.25)), 1.15, float(rng.uniform(0.18, 0.26))
        start = float(rng.uniform(0.0, 6.28))
        self.points = [
            (x + radius * math.cos(start + turn), y + radius * math.sin(start + turn))
            for turn in (0.0, 1.26, 2.51, 3.77, 5.03, 6.28)
        ]
        self.slip = rng.normal(1.0, 0.01, 2)
        self.speeds = [0.0, 0.0]
        self.drawn = 0.0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the pen is done."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the winches, and once the points of the drawing."""
        noise = self.rng.normal(0.0, 0.0005, 2)
        bus.publish("winches/length", Vector3(x=self.left + noise[0], y=self.right + noise[1], z=0.0))
        if round(self.time / DT) == 4:
            for x, y in self.points:
                bus.publish("drawing/point", Point(x=x, y=y, z=0.0))
            bus.publish("drawing/complete", Bool(data=True))

    def pen(self):
        """Return where the pen hangs."""
        x = (self.left**2 - self.right**2 + self.anchors**2) / (2.0 * self.anchors)
        return x, math.sqrt(max(0.0, self.left**2 - x**2))

    def off(self):
        """Return the distance of the pen from the lines of the drawing."""
        x, y = self.pen()
        nearest = 9.0
        for (ax, ay), (bx, by) in zip(self.points, self.points[1:], strict=False):
            dx, dy = bx - ax, by - ay
            part = max(0.0, min(1.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
            nearest = min(nearest, math.hypot(x - ax - part * dx, y - ay - part * dy))
        return nearest

    def advance(self, winches, down, state):
        """Draw for one step."""
        self.time += DT
        self.gained = -0.002
        wanted = (winches.x, winches.y) if winches else (0.0, 0.0)
        self.speeds = [have + 0.7 * (want - have) for have, want in zip(self.speeds, wanted, strict=True)]
        self.left += DT * self.speeds[0] * self.slip[0]
        self.right += DT * self.speeds[1] * self.slip[1]
        if self.left + self.right < self.anchors + 0.02:
            self.failure = "cord tears"
        elif self.time > 60.0:
            self.failure = "drawing takes too long"
        elif down and down.data:
            off = self.off()
            self.gained += 0.06 - 3.0 * max(0.0, off - 0.008)
            if off > 0.05:
                self.failure = "line is out of place"
        if state and state.data == "finished":
            self.over = True
            self.gained += 1.0
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["mural_plotter.py"],
    sensors=[
        Sensor("left", topic="winches/length", field="x", low=1.0, high=2.4, bins=7, unit="m"),
        Sensor("right", topic="winches/length", field="y", low=1.0, high=2.4, bins=7, unit="m"),
    ],
    drifts={"school": Drift(SCHOOL, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_draws(tarl, tarl_drift):
    """Draw one pentagon."""
    wall = Wall(tarl.rng("wall"), **(tarl_drift or STUDIO))
    tarl.start("mural_plotter.py", launch="studio.launch")
    while not wall.done:
        wall.publish(tarl.bus)
        tarl.step(DT)
        bus = tarl.bus
        wall.advance(bus.latest("winches/speed"), bus.latest("pen/down"), bus.latest("plotter/state"))
        tarl.reward(wall.gained)
    assert not wall.failure, wall.failure
