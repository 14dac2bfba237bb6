"""Sheets are bent to their angle. High-strength steel springs back more, so that three strokes are not enough."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.1
SHEETS = 4
RIGHT = 0.9  # deg
TIME_BOUND = 28.0


class Press:
    """A press with sheets that spring back by a share of their bending angle."""

    def __init__(self, rng, spring):
        self.rng = rng
        self.steel = "mild" if spring < 0.05 else "high strength"
        self.springs = [spring * rng.uniform(0.93, 1.07) for _ in range(SHEETS)]
        self.targets = [float(rng.choice([60.0, 75.0, 90.0, 105.0])) for _ in range(SHEETS)]
        self.at, self.bent, self.gap = 0, 0.0, 2
        self.travel, self.down = 0, False
        self.strokes, self.finished, self.error = 0, False, 0.0
        self.wrong = 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all sheets are bent, or the episode has failed."""
        return self.at == SHEETS or bool(self.failure)

    def publish(self, bus):
        """Publish the job, the steel's label, the punch and the angle that a relaxed sheet has."""
        here = self.gap == 0 and self.at < SHEETS
        bus.publish("job/steel", String(data=self.steel))
        bus.publish("job/angle", Float32(data=self.targets[self.at] if here else 0.0))
        bus.publish("press/down", Bool(data=self.down))
        bus.publish("press/measured", Float32(data=self.bent + self.rng.normal(0.0, 0.05)))

    def advance(self, stroke, unload):
        """Press, relax or unload for one step."""
        self.time += DT
        self.finished = False
        if self.gap:
            self.gap -= 1
            return
        wanted = stroke.data if stroke else 0.0
        if unload and unload.data and self.bent > 0.0:
            self.error = abs(self.bent - self.targets[self.at])
            self.wrong += self.error > RIGHT
            self.finished = True
            self.at, self.bent, self.gap, self.travel, self.down = self.at + 1, 0.0, 2, 0, False
        elif wanted > 0.0:
            self.travel += 1
            if self.travel == 4 and not self.down:
                self.down = True
                self.strokes += 1
                self.bent = max(self.bent, wanted * (1.0 - self.springs[self.at]))
        else:
            self.travel, self.down = 0, False

    def judge(self):
        """Return the reward of the step: each sheet is rewarded by its angle, time costs."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        elif self.at == SHEETS and self.wrong:
            self.failure = f"{self.wrong} sheets have a wrong angle"
        reward = -0.003
        if self.finished:
            reward += 2.5 - 0.8 * self.error / RIGHT if self.error <= RIGHT else -1.0
        return reward - 1.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["bender.py"],
    sensors=[
        Sensor("steel", topic="job/steel", field="data", categories=("mild", "high strength")),
        Sensor("angle", topic="press/measured", field="data", low=0, high=110, bins=5, unit="deg"),
    ],
    drifts={"high-strength steel": Drift.range(0.085, 0.125)},
    episodes=100,
    min_success=0.95,
)
def test_bends(tarl, tarl_drift):
    """Bend one batch."""
    press = Press(tarl.rng("press"), tarl_drift or 0.035)
    tarl.start("bender.py")
    while not press.done:
        press.publish(tarl.bus)
        tarl.step(DT)
        press.advance(tarl.bus.latest("press/stroke"), tarl.bus.latest("press/unload"))
        tarl.reward(press.judge())
    assert not press.failure, press.failure
