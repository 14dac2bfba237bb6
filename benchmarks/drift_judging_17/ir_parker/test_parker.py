"""A robot parks before a wall by an infrared ranger. The new board has a reference of 3.3 V; the old one had 5 V."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/Float32")
UInt16 = message_type("std_msgs/UInt16")

DT = 0.1
OLD_BOARD = 5.0
NEW_BOARD = 3.3


class Wall:
    """A wall ahead; the converter has the reference voltage `reference`."""

    def __init__(self, rng, reference):
        self.rng = rng
        self.reference = reference
        self.curve = rng.normal(1.0, 0.01)
        self.gap = float(rng.uniform(0.9, 1.2))
        self.goals = [float(rng.uniform(0.45, 0.6)), float(rng.uniform(0.28, 0.36))]
        self.reached, self.speed, self.time = [], 0.0, 0.0
        self.gained, self.failure = 0.0, ""

    @property
    def done(self):
        """Return whether both goals are reached, or something went wrong."""
        return bool(self.failure) or len(self.reached) == 2

    def publish(self, bus):
        """Publish what the converter reads, and the goal."""
        volts = (self.curve * 0.6 / self.gap) ** (1 / 1.1) + self.rng.normal(0.0, 0.006)
        raw = max(0, min(1023, round(volts / self.reference * 1023)))
        bus.publish("adc/a3", UInt16(data=raw))
        bus.publish("head/wanted_distance", Float32(data=self.goals[len(self.reached)]))

    def advance(self, cmd, there):
        """Drive for one step."""
        self.speed += 0.6 * ((cmd.linear.x if cmd else 0.0) - self.speed)
        self.gap -= DT * self.speed
        self.time += DT
        goal = self.goals[len(self.reached)]
        off = self.gap - goal
        self.gained = -0.02 * min(1.0, abs(off)) - 0.002
        if there and there.data:
            self.reached.append(self.gap)
            self.gained += 3.0 * max(0.0, 1.0 - (off / 0.06) ** 2)
            if abs(off) > 0.045:
                self.failure = f"robot parks {100 * off:.0f} cm beside its goal"
        if self.gap < 0.2:
            self.failure = "head hits the wall"
        elif self.time > 40.0:
            self.failure = "robot takes too long"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["parker.py", "ranger.py"],
    sensors=[
        Sensor("raw", topic="adc/a3", field="data", low=80.0, high=650.0, bins=6),
        Sensor("goal", topic="head/wanted_distance", field="data", low=0.25, high=0.65, bins=2, unit="m"),
    ],
    drifts={"new board": Drift(NEW_BOARD, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_parks(tarl, tarl_drift):
    """Park at two distances, one after the other."""
    wall = Wall(tarl.rng("wall"), tarl_drift or OLD_BOARD)
    tarl.start("parker.py")
    while not wall.done:
        wall.publish(tarl.bus)
        tarl.step(DT)
        wall.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("parker/there"))
        tarl.reward(wall.gained)
    assert not wall.failure, wall.failure
