"""A revolving stage turns to its cues. Its drive wheel is worn, so it turns less than the encoder tells."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.2
CUES = 3
EVERY = 17.0  # time between two cues (s)
TOLERANCE = 5.0  # degrees
NEW, WORN = 0.125, 0.104  # m


class Stage:
    """A round stage on wheels, one of which is driven; `radius` is that of the driven wheel in m."""

    def __init__(self, rng, radius):
        self.rng = rng
        self.per_turn = radius * rng.uniform(0.997, 1.003) / 4.5
        self.lag = rng.uniform(0.3, 0.5)
        self.cues = [rng.uniform(60.0, 90.0)]
        while len(self.cues) < CUES:
            self.cues.append(self.cues[-1] + float(rng.choice([-1.0, 1.0])) * rng.uniform(40.0, 85.0) + 15.0)
        self.motor, self.wheel, self.angle = 0.0, 0.0, 0.0
        self.time, self.cue = 0.0, 0
        self.gained = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the show is over, or was stopped."""
        return bool(self.failure) or self.cue >= CUES

    def publish(self, bus):
        """Publish the encoder, the cue, and that nobody has pressed the emergency stop."""
        counts = self.wheel / (2.0 * math.pi) * 24.0 * 2048.0
        bus.publish("turntable/encoder", Int32(data=round(counts)))
        bus.publish("show/cue", Float32(data=self.cues[self.cue]))

    def advance(self, rpm, brake):
        """Turn for one step."""
        wanted = rpm.data * 2.0 * math.pi / 60.0 / 24.0 if rpm else 0.0
        if brake is None or brake.data:
            self.motor = 0.0
        else:
            self.motor += (wanted - self.motor) * (1.0 - math.exp(-DT / self.lag))
        turned = self.motor * DT
        self.wheel += turned
        self.angle += turned * self.per_turn * (1.0 + self.rng.normal(0.0, 0.01))
        self.time += DT
        self.gained = -0.001
        if self.time > EVERY * (self.cue + 1):
            self._scene()

    def _scene(self):
        error = abs(math.degrees(self.angle) - self.cues[self.cue])
        self.cue += 1
        if error > TOLERANCE:
            self.failure = f"scene {self.cue} is turned away by {error:.0f} degrees"
        else:
            self.gained += 10.0 / CUES * (1.0 - 0.3 * (error / TOLERANCE) ** 2)

    def judge(self):
        """Return the reward of the step: scenes that face the audience."""
        return self.gained - (3.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["stage_turntable.py"],
    sensors=[
        Sensor("cue", topic="show/cue", field="data", low=0.0, high=270.0, bins=6, unit="°"),
        Sensor("counts", topic="turntable/encoder", field="data", low=0.0, high=1.6e6, bins=6),
    ],
    drifts={"worn wheel": Drift(WORN, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_turns(tarl, tarl_drift):
    """Turn to the cues of one act."""
    stage = Stage(tarl.rng("stage"), tarl_drift or NEW)
    tarl.start("stage_turntable.py")
    while not stage.done:
        stage.publish(tarl.bus)
        tarl.step(DT)
        stage.advance(tarl.bus.latest("turntable/motor_rpm"), tarl.bus.latest("turntable/brake"))
        tarl.reward(stage.judge())
    assert not stage.failure, stage.failure
