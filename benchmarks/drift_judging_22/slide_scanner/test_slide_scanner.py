"""A microscope scans a slide. Its stage got a finer lead screw, for good."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
COARSE = {"pitch": 2.0}
FINE = {"pitch": 1.5}  # mm per turn


class Stage:
    """A stage with a lead screw of some `pitch`, in mm."""

    def __init__(self, rng, pitch):
        self.rng = rng
        self.mm = pitch / 3200.0 * rng.normal(1.0, 0.0008)
        self.offset = rng.normal(0.0, 0.01)
        self.steps, self.rate = 0.0, 30000.0 * float(rng.uniform(0.9, 1.1))
        self.moving, self.shots = False, []
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the scan is over."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the driver's counter, and whether the motor turns."""
        if round(self.time / DT) == 2:
            bus.publish("scanner/start", Bool(data=True))
        bus.publish("stage/steps", Int32(data=int(self.steps)))
        bus.publish("stage/moving", Bool(data=self.moving))

    def advance(self, target, shots, state):
        """Move the stage for one step, and take the images that were triggered."""
        self.time += DT
        self.gained = 0.0
        for _ in range(shots):
            self.expose()
        left = (target.data if target else 0) - self.steps
        reach = self.rate * DT
        self.steps += max(-reach, min(reach, left))
        self.moving = abs(left) > reach
        if self.steps * self.mm > 20.0:
            self.failure = "stage hits its end"
        elif self.time > 12.0:
            self.failure = "scan takes too long"
        elif state and state.data == "finished":
            self.over = True
            self.gained += 1.0
            if len(self.shots) != 7:
                self.failure = "images are missing"
        if self.failure:
            self.gained -= 5.0

    def expose(self):
        """Take an image, which must overlap with the one before."""
        want = 1.5 + 2.2 * len(self.shots)
        off = abs(self.steps * self.mm + self.offset - want)
        self.shots.append(off)
        self.gained += 1.0 - 2.0 * max(0.0, off - 0.02)
        if self.moving:
            self.gained -= 0.5
        if off > 0.4:
            self.failure = "images do not fit together"


@pytest.mark.tarl(
    nodes=["slide_scanner.py"],
    sensors=[
        Sensor("steps", topic="stage/steps", field="data", low=0.0, high=40000.0, bins=8),
    ],
    drifts={"fine": Drift(FINE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_scans(tarl, tarl_drift):
    """Scan one slide."""
    stage = Stage(tarl.rng("stage"), **(tarl_drift or COARSE))
    tarl.start("slide_scanner.py")
    triggers = []
    tarl.bus.subscribe("camera/trigger", triggers.append)
    while not stage.done:
        stage.publish(tarl.bus)
        tarl.step(DT)
        stage.advance(tarl.bus.latest("stage/target"), len(triggers), tarl.bus.latest("scanner/state"))
        triggers.clear()
        tarl.reward(stage.gained)
    assert not stage.failure, stage.failure
