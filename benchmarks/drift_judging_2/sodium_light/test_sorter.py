"""Tomatoes are sorted by colour. Under a sodium lamp all fruits look the same, and no repair is possible."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
ColorRGBA = message_type("std_msgs/msg/ColorRGBA")
String = message_type("std_msgs/msg/String")

DT = 0.1
SPACING = 20  # number of steps from one fruit to the next
VIEW = 5  # number of steps for which a fruit is in view
FLAP = 12  # number of steps from the middle of the view to the flap
FRUITS = 6
WRONG = 1  # maximum number of fruits sorted wrongly


class Belt:
    """A belt with ripe and green fruits; `mono` is the share of sodium light."""

    def __init__(self, rng, mono):
        self.rng = rng
        self.lamp = "sodium" if mono > 0.5 else "daylight"
        self.mono = mono
        self.green = [bool(rng.random() < 0.5) for _ in range(FRUITS)]
        self.tint = [rng.normal(0.0, 0.02) for _ in range(FRUITS)]
        self.first = int(rng.integers(3, 10))
        self.step = 0
        self.sorted, self.wrong = 0, 0
        self.failure = ""

    @property
    def done(self):
        """Return whether all fruits are sorted."""
        return self.sorted == FRUITS

    def fruit(self, behind):
        """Return the fruit that is this many steps behind the edge of the view, and its distance."""
        return divmod(self.step - self.first - behind, SPACING)

    def publish(self, bus):
        """Publish the lamp and the camera's colour, which is that of the fruit or that of the lamp."""
        index, since = self.fruit(0)
        there = 0 <= index < FRUITS and since < VIEW
        colour = (0.5, 0.5, 0.5)
        if there:
            own = (0.35, 0.65, 0.2) if self.green[index] else (0.75, 0.2, 0.12)
            colour = tuple(
                (1.0 - self.mono) * part + self.mono * lamp + self.rng.normal(0.0, 0.02)
                for part, lamp in zip(own, (0.7, 0.5 + self.tint[index], 0.1), strict=True)
            )
        red, green, blue = (max(0.0, part) for part in colour)
        bus.publish("camera/lamp", String(data=self.lamp))
        bus.publish("camera/in_view", Bool(data=there))
        bus.publish("camera/colour", ColorRGBA(r=red, g=green, b=blue, a=1.0))

    def judge(self, flap):
        """Return the reward of the step: positive for a fruit sorted correctly, else negative."""
        index, since = self.fruit(FLAP)
        self.step += 1
        if since != 0 or not 0 <= index < FRUITS:
            return 0.0
        right = bool(flap and flap.data) == self.green[index]
        self.sorted += 1
        self.wrong += not right
        if self.wrong > WRONG:
            self.failure = "sorted no better than a coin toss"
        return 10.0 / FRUITS if right else -10.0 / FRUITS


@pytest.mark.tarl(
    nodes=["sorter.py"],
    sensors=[
        Sensor("lamp", topic="camera/lamp", field="data", categories=("daylight", "sodium")),
        Sensor("red", topic="camera/colour", field="r", low=0, high=1, bins=5),
    ],
    drifts={"sodium lamp": 1.0},
    episodes=100,
    min_success=0.95,
)
def test_sorts(tarl, tarl_drift):
    """Sort some fruits."""
    belt = Belt(tarl.rng("belt"), tarl_drift or 0.0)
    tarl.start("sorter.py")
    while not belt.done:
        belt.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(belt.judge(tarl.bus.latest("flap")))
    assert not belt.failure, belt.failure
