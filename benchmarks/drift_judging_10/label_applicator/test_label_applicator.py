"""A machine sticks labels on bottles.

Since its pulley was replaced, the belt permanently moves further per count.
"""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.02
BOTTLES = 6
WHEEL = 0.40  # travel per count of either encoder (mm)
EYE_TO_PEEL = 180.0  # mm
LABEL = 80.0  # mm
TIME_BOUND = 16.0


class Line:
    """A belt with bottles, and a web of labels whose front edge is at the peel edge."""

    def __init__(self, rng, ratio):
        self.rng = rng
        self.ratio = ratio
        self.bottles = []  # positions of the front edges of bottles without a label
        place = -60.0
        for _ in range(BOTTLES):
            self.bottles.append(place)
            place -= rng.uniform(190.0, 260.0)
        self.fronts = list(self.bottles)
        self.speed = rng.uniform(190.0, 230.0)
        self.belt, self.web, self.web_speed = 0.0, 0.0, 0.0
        self.feeding, self.began = False, 0.0
        self.right, self.wrong, self.scrap = 0, 0, ""
        self.mismatch = -1.0
        self.time = 0.0
        self.gained = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all bottles have passed, or the episode has failed."""
        return bool(self.failure) or self.right + self.wrong >= BOTTLES

    def publish(self, bus):
        """Publish both encoders and the eye."""
        bus.publish("belt/counts", Int32(data=int(self.belt / (WHEEL * self.ratio))))
        bus.publish("web/counts", Int32(data=int(self.web / WHEEL)))
        bus.publish("eye/blocked", Bool(data=any(0.0 <= front < 60.0 for front in self.fronts)))

    def advance(self, cmd):
        """Move belt and web for one step, and judge labels that begin or end."""
        self.time += DT
        self.gained = 0.0
        moved = max(0.0, self.speed + self.rng.normal(0.0, 3.0)) * DT
        self.belt += moved
        self.fronts = [front + moved for front in self.fronts]
        self.web_speed += 0.5 * ((cmd.data if cmd else 0.0) - self.web_speed)
        self.web += self.web_speed * DT
        if self.web_speed > 20.0 and not self.feeding:
            self.feeding = True
            self.begin()
        if self.feeding:
            self.mismatch = max(self.mismatch, self.web_speed / self.speed - 1.0)
        if self.web_speed < 8.0 and self.feeding:
            self.feeding = False
            self.end()
        if not self.feeding and self.bottles and self.fronts[-len(self.bottles)] > EYE_TO_PEEL + 40.0:
            self.bottles.pop(0)
            self.wrong += 1

    def begin(self):
        """Stick the front of a label on the bottle at the peel edge."""
        self.began = self.web - self.web_speed * DT
        miss = self.fronts[-len(self.bottles)] - EYE_TO_PEEL if self.bottles else 99.0
        if not self.bottles or abs(miss) > 10.0:
            self.scrap = "a label missed its bottle"

    def end(self):
        """Take stock of a label that is on."""
        if self.bottles:
            self.bottles.pop(0)
        length = self.web - self.began
        if self.scrap or abs(length - LABEL) > 6.0 or abs(self.mismatch) > 0.15:
            self.wrong += 1
        else:
            self.right += 1
            self.gained = 10.0 / BOTTLES
        self.scrap, self.mismatch = "", -1.0

    def judge(self):
        """Return the reward of the step."""
        if self.wrong > 1:
            self.failure = "two bottles have no straight label"
        elif self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        return self.gained - 0.0003 - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["label_applicator.py"],
    sensors=[
        Sensor("eye", topic="eye/blocked", field="data"),
        Sensor("web_speed", low=0.0, high=320.0, bins=4, unit="mm/s"),
    ],
    drifts={"another pulley": Drift(1.6, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_labels_bottles(tarl, tarl_drift):
    """Label a batch of bottles."""
    line = Line(tarl.rng("line"), tarl_drift or 1.25)
    tarl.start("label_applicator.py")
    while not line.done:
        tarl.observe(web_speed=line.web_speed)
        line.publish(tarl.bus)
        tarl.step(DT)
        line.advance(tarl.bus.latest("web/speed"))
        tarl.reward(line.judge())
    assert not line.failure, line.failure
