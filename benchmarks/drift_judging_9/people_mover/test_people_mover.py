"""A people mover stops at its platforms. Ice on the running surface leaves the wheels less adhesion to brake with."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
GRAVITY = 9.81
RIGHT = 0.35  # allowed offset between train doors and platform doors (m)
BOARDING = 25  # steps
TIME_BOUND = 150.0


class Line:
    """A train whose wheels transmit no more force than the adhesion allows, on a line with three platforms."""

    def __init__(self, rng, adhesion):
        self.rng = rng
        self.adhesion = adhesion * rng.uniform(0.96, 1.04)
        self.platforms = list(rng.uniform(110.0, 190.0, 3))
        self.distance, self.speed = self.platforms.pop(0), 0.0
        self.boarding, self.missed = 0, 0.0
        self.arrived = False
        self.served = 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all platforms are served, or the episode has failed."""
        return self.served == 3 or bool(self.failure)

    def publish(self, bus):
        """Publish the distance to the platform, the speed and the adhesion that the ice detector estimates."""
        bus.publish("track/adhesion", Float32(data=self.adhesion + self.rng.normal(0.0, 0.003)))
        bus.publish("platform/distance", Float32(data=self.distance + self.rng.normal(0.0, 0.01)))
        bus.publish("wheel/speed", Float32(data=self.speed + self.rng.normal(0.0, 0.005)))

    def advance(self, traction, doors):
        """Move the train for one step, or board passengers."""
        self.time += DT
        self.arrived = False
        if doors and doors.data:
            self.boarding += 1
            if self.boarding == BOARDING:
                self.missed = abs(self.distance)
                self.arrived = True
                self.served += 1
                self.boarding = 0
                if self.platforms:
                    self.distance = self.platforms.pop(0)
            return
        grip = self.adhesion * GRAVITY
        force = max(-grip, min(grip, traction.data if traction else 0.0))
        self.speed = max(0.0, self.speed + (force - 0.01) * DT)
        self.distance -= self.speed * DT

    def judge(self):
        """Return the reward of the step: each stop at a platform is rewarded by its accuracy, and time costs."""
        if self.distance < -RIGHT:
            self.failure = "ran past the platform"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        reward = -0.001
        if self.arrived:
            reward += 3.5 - self.missed
        return reward - 3.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["people_mover.py"],
    sensors=[
        Sensor("adhesion", topic="track/adhesion", field="data", low=0.04, high=0.24, bins=5),
        Sensor("distance", topic="platform/distance", field="data", low=0, high=200, bins=8, unit="m"),
        Sensor("speed", topic="wheel/speed", field="data", low=0, high=10, bins=5, unit="m/s"),
    ],
    drifts={"ice": Drift(0.07)},
    episodes=100,
    min_success=0.95,
)
def test_serves_platforms(tarl, tarl_drift):
    """Serve three platforms."""
    line = Line(tarl.rng("line"), tarl_drift or 0.22)
    tarl.start("people_mover.py")
    while not line.done:
        line.publish(tarl.bus)
        tarl.step(DT)
        line.advance(tarl.bus.latest("traction"), tarl.bus.latest("doors/open"))
        tarl.reward(line.judge())
    assert not line.failure, line.failure
