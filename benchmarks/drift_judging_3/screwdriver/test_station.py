"""Screws clamp with 8 kN. Waxed screws have less friction, so the same torque clamps harder and tears the thread."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float64 = message_type("std_msgs/Float64")
Int32 = message_type("std_msgs/Int32")
String = message_type("std_msgs/String")

DT = 0.05
SCREWS = 3
CLAMP = 8.0  # kN
WINDOW = 0.13  # share of it
PER_TURN = 20.0  # force per turn after the head touches the flange (kN)
DIAMETER = 6.0  # mm
TIME_BOUND = 30.0


class Flange:
    """A part with holes; screws have a coefficient of friction of about `friction`."""

    def __init__(self, rng, friction):
        self.rng = rng
        self.coating = "zinc" if friction > 0.17 else "wax"
        self.friction = [friction * rng.uniform(0.96, 1.04) for _ in range(SCREWS)]
        self.seat = [rng.uniform(2.5, 3.5) for _ in range(SCREWS)]
        self.turns, self.rpm, self.at, self.judged = 0.0, 0.0, 0, 0
        self.clamps = [0.0] * SCREWS
        self.time = 0.0
        self.finished = False
        self.failure = ""

    @property
    def done(self):
        """Return whether the part has been taken away, or the episode has failed."""
        return self.finished or bool(self.failure)

    def torque(self):
        """Return the torque at the spindle: Nm."""
        ripple = self.rng.normal(0.0, 0.08)
        if self.rpm < 0.05:  # lifted
            return ripple
        return 0.2 + self.friction[self.at] * self.clamps[self.at] * DIAMETER + ripple

    def publish(self, bus):
        """Publish job, feeder, encoder and transducer."""
        bus.publish("station/screws", Int32(data=SCREWS))
        bus.publish("feeder/coating", String(data=self.coating))
        bus.publish("spindle/turns", Float64(data=self.turns))
        bus.publish("spindle/torque", Float64(data=self.torque()))

    def advance(self, rpm, screw, done):
        """Turn for one step."""
        at = screw.data if screw else 0
        if at != self.at:
            self.at, self.turns = at, 0.0
        wanted = max(0.0, min(200.0, rpm.data)) if rpm else 0.0
        self.rpm += (wanted - self.rpm) * 0.9
        self.turns += self.rpm / 60.0 * DT
        self.clamps[at] = PER_TURN * max(0.0, self.turns - self.seat[at])
        self.finished = bool(done and done.data)
        self.time += DT

    def judge(self):
        """Return the reward of the step, for a screw whose successor has begun."""
        reward = -0.002
        while self.judged < (SCREWS if self.finished else self.at):
            wrong = abs(self.clamps[self.judged] / CLAMP - 1.0)
            if wrong > WINDOW:
                self.failure = f"a screw clamps with {self.clamps[self.judged]:.1f} kN"
            reward += 3.6 - 5.0 * wrong if wrong <= WINDOW else -2.0
            self.judged += 1
        if self.time > TIME_BOUND:
            self.failure = "late"
            reward -= 5.0
        return reward


@pytest.mark.tarl(
    nodes=["station.py"],
    sensors=[
        Sensor("coating", topic="feeder/coating", field="data", categories=("zinc", "wax")),
        Sensor("torque", topic="spindle/torque", field="data", low=0, high=12, bins=6, unit="Nm"),
    ],
    drifts={"wax": 0.145},
    episodes=100,
    min_success=0.95,
)
def test_clamps(tarl, tarl_drift):
    """Tighten one part."""
    flange = Flange(tarl.rng("flange"), tarl_drift or 0.2)
    settings = yaml.safe_load(Path(__file__).with_name("params.yaml").read_text())
    tarl.start("station.py", parameters=settings)
    while not flange.done:
        flange.publish(tarl.bus)
        tarl.step(DT)
        latest = tarl.bus.latest
        flange.advance(latest("spindle/rpm"), latest("spindle/screw"), latest("station/done"))
        tarl.reward(flange.judge())
    assert not flange.failure, flange.failure
