"""Seeds lie at the spacing of the job within 6.5 %. On wet soil the gauge wheel picks up mud and turns more slowly."""

from math import pi

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
FIELD = 40.0  # length of the row (m)
ROLLING = {"dry": 0.40, "wet": 0.462}  # rolling diameter of the wheel, m
MOISTURE = {"dry": (0.10, 0.26), "wet": (0.40, 0.60)}


class Row:
    """A tractor that pulls the drill, and a row in which seeds are counted."""

    def __init__(self, rng, soil):
        self.rng = rng
        self.moisture = rng.uniform(*MOISTURE[soil])
        self.rolling = ROLLING[soil] * rng.uniform(0.99, 1.01)
        self.spacing = rng.uniform(0.12, 0.20)
        self.speed = self.cruise = rng.uniform(1.8, 2.6)
        self.x, self.turns, self.time = -1.0, 0.0, 0.0
        self.seeds = self.moved = self.error = 0.0
        self.recent = []
        self.failure = ""

    @property
    def done(self):
        """Return whether the row is sown, or the episode has failed."""
        return self.x >= FIELD or bool(self.failure)

    def publish(self, bus):
        """Publish the job, the soil and the pulses of the gauge wheel."""
        bus.publish("job/spacing", Float32(data=self.spacing))
        bus.publish("soil/moisture", Float32(data=self.moisture + self.rng.normal(0.0, 0.02)))
        bus.publish("gauge_wheel/pulses", Int32(data=int(self.turns * 60)))
        bus.publish("row/lowered", Bool(data=self.x > 0.0))

    def advance(self, rpm):
        """Drive for one step and drop seeds."""
        self.time += DT
        self.speed += 0.3 * DT * (self.cruise - self.speed) + self.rng.normal(0.0, 0.02)
        self.moved = self.speed * DT
        self.x += self.moved
        self.turns += self.moved / (pi * self.rolling) * (1.0 + self.rng.normal(0.0, 0.01))
        if self.x > 0.0:
            dropped = (rpm.data if rpm else 0.0) / 60.0 * 36 * DT * (1.0 + self.rng.normal(0.0, 0.02))
            self.seeds += dropped
            self.recent = [*self.recent[-9:], dropped * self.spacing / self.moved]

    def judge(self):
        """Return the reward of the step: at most 10 in total for metres with the right spacing."""
        if self.x <= 0.0 or len(self.recent) < 10:
            return 0.0
        if self.x >= FIELD:
            self.error = self.seeds * self.spacing / self.x - 1.0
            if abs(self.error) > 0.065:
                self.failure = f"{100 * self.error:+.0f} % of the seeds"
                return -4.0
        near = abs(sum(self.recent) / 10.0 - 1.0)
        return 10.0 * self.moved / FIELD * max(0.0, 1.0 - (near / 0.13) ** 2)


@pytest.mark.tarl(
    nodes=["meter.py"],
    sensors=[
        Sensor("moisture", topic="soil/moisture", field="data", low=0, high=0.7, bins=7),
        Sensor("spacing", topic="job/spacing", field="data", low=0.12, high=0.20, bins=2, unit="m"),
    ],
    drifts={"wet soil": "wet"},
    episodes=80,
    min_success=0.95,
)
def test_sows(tarl, tarl_drift):
    """Sow one row."""
    row = Row(tarl.rng("row"), tarl_drift or "dry")
    tarl.start("meter.py")
    while not row.done:
        row.publish(tarl.bus)
        tarl.step(DT)
        row.advance(tarl.bus.latest("meter/rpm"))
        tarl.reward(row.judge())
    assert not row.failure, row.failure
