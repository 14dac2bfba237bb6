"""A brush washes the side of a car. New bristles of foam draw less current for the same force, for good."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")

DT = 0.05
LENGTH = 4.5  # length of the car (m)
PORTAL = 0.25  # m/s
STIFF = 400.0  # force per metre of penetration (N/m)
SCRATCH = 80.0  # N
WASHED = 22.0  # minimum force (N)
TIME_BOUND = 30.0


class Bay:
    """A portal that drives along a car, with a brush on an arm."""

    def __init__(self, rng, per_newton):
        self.rng = rng
        self.per_newton = per_newton * rng.uniform(0.97, 1.03)
        self.side = rng.uniform(0.35, 0.5)  # distance from the parked brush (m)
        self.bulge = rng.uniform(0.03, 0.06), rng.uniform(0.0, 6.0)
        self.portal, self.arm, self.speed = 0.0, 0.0, 0.0
        self.waiting = 6.0  # time before the portal drives (s)
        self.clean, self.scratched = 0.0, 0.0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def force(self):
        """Return the force between brush and car, N."""
        wall = self.side - self.bulge[0] * math.sin(1.4 * self.portal + self.bulge[1])
        return max(0.0, STIFF * (self.arm - wall))

    @property
    def done(self):
        """Return whether the portal has passed the car, or the episode has failed."""
        return self.portal >= LENGTH or bool(self.failure)

    def publish(self, bus):
        """Publish the motor's current and the light barrier."""
        current = 2.0 + self.per_newton * self.force + self.rng.normal(0.0, 0.06)
        bus.publish("brush/current", Float32(data=current))
        bus.publish("portal/over_car", Bool(data=True))

    def advance(self, cmd):
        """Move arm and portal for one step."""
        self.time += DT
        self.speed += 0.5 * ((cmd.data if cmd else 0.0) - self.speed)
        self.arm = max(0.0, self.arm + self.speed * DT)
        moved = PORTAL * DT if self.time > self.waiting else 0.0
        self.portal += moved
        washed = WASHED < self.force < SCRATCH
        self.clean += moved if washed else 0.0
        self.gained = 10.0 * moved / LENGTH if washed else 0.0
        self.scratched = self.scratched + DT if self.force > SCRATCH else 0.0

    def judge(self):
        """Return the reward of the step: clean metres count."""
        if self.scratched > 0.3:
            self.failure = "the brush scratches the paint"
        elif self.portal >= LENGTH and self.clean < 0.9 * LENGTH:
            self.failure = "the car is still dirty"
        return -4.0 if self.failure else self.gained - 0.0005


@pytest.mark.tarl(
    nodes=["carwash_brush.py"],
    sensors=[
        Sensor("current", topic="brush/current", field="data", low=2.0, high=5.0, bins=5, unit="A"),
        Sensor("portal", low=0.0, high=4.5, bins=4, unit="m"),
    ],
    drifts={"foam bristles": Drift(0.0150, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_washes(tarl, tarl_drift):
    """Wash the side of one car."""
    bay = Bay(tarl.rng("bay"), tarl_drift or 0.030)
    tarl.start("carwash_brush.py")
    while not bay.done:
        tarl.observe(portal=bay.portal)
        bay.publish(tarl.bus)
        tarl.step(DT)
        bay.advance(tarl.bus.latest("arm/speed"))
        tarl.reward(bay.judge())
    assert not bay.failure, bay.failure
