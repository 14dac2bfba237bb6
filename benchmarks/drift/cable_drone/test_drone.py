"""The drone stays in front of the inspected place, even in a steady wind; each axis is rewarded in each step."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

PointStamped = message_type("geometry_msgs/msg/PointStamped")

DT = 0.1
DURATION = 9.0
PLACE = (0.0, 2.0, 5.0)
BLURRED = 0.3  # error in one axis (m)


class Wall:
    """A drone of 2 kg on cables; from a random moment on, `wind` N push in each of the three directions."""

    def __init__(self, rng, wind):
        self.rng = rng
        self.begin = rng.uniform(1.5, 3.0)
        self.wind = [wind * side * rng.uniform(0.9, 1.1) for side in (1.0, -1.0, 1.2)]
        self.place = [at + rng.uniform(-0.1, 0.1) for at in PLACE]
        self.speed = [0.0, 0.0, 0.0]
        self.time = 0.0
        self.blurred = 0

    def publish(self, bus):
        """Publish the position of the drone."""
        place = PointStamped()
        place.point.x, place.point.y, place.point.z = (at + self.rng.normal(0.0, 0.002) for at in self.place)
        bus.publish("/place", place)

    def advance(self, command):
        """Fly for one step."""
        force = (command.x, command.y, command.z) if command else (0.0, 0.0, 0.0)
        blowing = max(0.0, min(1.0, self.time - self.begin))
        for i in range(3):
            push = max(-12.0, min(12.0, force[i])) + blowing * self.wind[i] - 0.8 * self.speed[i]
            self.speed[i] += push / 2.0 * DT
            self.place[i] += self.speed[i] * DT
        self.time += DT

    def judge(self):
        """Return the reward of the step: a third for each axis whose error is small enough."""
        off = [abs(at - wanted) for at, wanted in zip(self.place, PLACE, strict=True)]
        self.blurred += max(off) > BLURRED
        return sum(0.04 if one <= BLURRED else -0.08 for one in off)


@pytest.mark.tarl(
    nodes=["drone.py"],
    sensors=[Sensor("beside", topic="/place", field="point.x", low=-1, high=1, bins=8, unit="m")],
    drifts={"wind": 2.2},
    episodes=100,
    min_success=0.95,
)
def test_holds_its_place(tarl, tarl_drift):
    """Blur the image for at most one second."""
    wall = Wall(tarl.rng("wall"), tarl_drift or 0.0)
    tarl.start("drone.py")
    while wall.time < DURATION:
        wall.publish(tarl.bus)
        tarl.step(DT)
        wall.advance(tarl.bus.latest("/force"))
        tarl.reward(wall.judge())
    assert wall.blurred <= 10, f"blurred for {wall.blurred} steps"
