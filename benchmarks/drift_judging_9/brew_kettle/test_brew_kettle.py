"""A kettle holds its rests.

In a yard the kettle loses more heat; how much depends on the wind, which no sensor measures.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 1.0
HEATS = 0.65  # heating rate at full duty (K/s)
RIGHT = 1.2  # K
RESTS = {"maltose": 63.0, "sugar": 72.0}
HELD = 70.0  # time of each rest within the right temperature (s)
TIME_BOUND = 600.0


class Kettle:
    """A kettle that is heated by an element and loses heat to a room at 20 degrees."""

    def __init__(self, rng, loss):
        self.rng = rng
        self.loss = loss * rng.uniform(0.97, 1.03)
        self.temperature = rng.uniform(52.0, 56.0)
        self.element = 0.0
        self.held = dict.fromkeys(RESTS, 0.0)
        self.rest = ""
        self.mashed = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the mash is done, or the episode has failed."""
        return self.mashed or bool(self.failure)

    def publish(self, bus):
        """Publish the temperature and the level."""
        bus.publish("kettle/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 0.03)))
        bus.publish("kettle/level", Float32(data=24.0))

    def advance(self, duty, rest, finished):
        """Heat for one step; the element follows its duty with a lag."""
        self.time += DT
        self.element += 0.4 * ((duty.data if duty else 0.0) - self.element)
        self.temperature += (HEATS * self.element - self.loss * (self.temperature - 20.0)) * DT
        self.rest = rest.data if rest else ""
        self.mashed = bool(finished and finished.data)

    def judge(self):
        """Return the reward of the step: seconds at the temperature of the rest are rewarded, and time costs."""
        reward = -0.002
        if self.rest in RESTS and abs(self.temperature - RESTS[self.rest]) < RIGHT:
            self.held[self.rest] += DT
            if self.held[self.rest] <= HELD:
                reward += 5.0 / HELD
        if self.time > TIME_BOUND and not self.mashed:
            self.failure = "the mash is not done"
        elif self.mashed and min(self.held.values()) < HELD:
            self.failure = "a rest was too cold"
        return reward - 3.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["brew_kettle.py", "pid.py"],
    sensors=[
        Sensor(
            "temperature", topic="kettle/temperature", field="data", low=52, high=74, bins=11, unit="degC"
        ),
    ],
    drifts={"windy yard": Drift.range(0.0062, 0.0084)},
    episodes=100,
    min_success=0.95,
)
def test_mashes(tarl, tarl_drift):
    """Mash once."""
    kettle = Kettle(tarl.rng("kettle"), tarl_drift or 0.65 * 0.0062)
    tarl.start("brew_kettle.py")
    while not kettle.done:
        kettle.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        kettle.advance(latest("kettle/duty"), latest("mash/rest"), latest("mash/done"))
        tarl.reward(kettle.judge())
    assert not kettle.failure, kettle.failure
