"""A fork truck takes a pallet. Its laser was knocked against a rack, and no longer looks where it did."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Pose2D = message_type("geometry_msgs/Pose2D")

DT = 0.1
FORKS = 1.15  # distance ahead of the axle (m)
POCKET = 0.05  # distance to either side (m)
ASKEW = 0.06  # rad
TIME_BOUND = 40.0
BUILT, KNOCKED = 0.785, 0.685  # rad


class Aisle:
    """A truck in front of a pallet; `yaw` is how its laser is turned, in rad."""

    def __init__(self, rng, yaw):
        self.rng = rng
        self.yaw = yaw + rng.uniform(-0.005, 0.005)
        self.x, self.y = -rng.uniform(4.2, 5.0), rng.uniform(-0.3, 0.3)
        self.heading = rng.uniform(-0.12, 0.12)
        self.lag = rng.uniform(0.15, 0.25)
        self.pull = rng.uniform(-0.01, 0.01)
        self.v, self.turn = 0.0, 0.0
        self.entered, self.loaded = False, False
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the pallet is on the forks, or cannot be."""
        return bool(self.failure) or self.loaded

    def publish(self, bus):
        """Publish the pallet in the frame of the laser, and the switch at the end of the forks."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        laser = (self.x + c * 0.35 - s * 0.42, self.y + s * 0.35 + c * 0.42)
        look = self.heading + self.yaw
        c, s = math.cos(look), math.sin(look)
        seen = Pose2D()
        seen.x = -c * laser[0] - s * laser[1] + self.rng.normal(0.0, 0.006)
        seen.y = s * laser[0] - c * laser[1] + self.rng.normal(0.0, 0.006)
        seen.theta = -look + self.rng.normal(0.0, 0.006)
        bus.publish("pallet/pose", seen)
        bus.publish("forks/switch", Bool(data=self.loaded))

    def advance(self, command):
        """Drive for one step, up to the pallet and into it."""
        share = 1.0 - math.exp(-DT / self.lag)
        self.v += (command.linear.x - self.v) * share if command else 0.0
        self.turn += (command.angular.z - self.turn) * share if command else 0.0
        before = self.x
        self.heading += (self.turn + self.v * (self.pull + self.rng.normal(0.0, 0.02))) * DT
        self.x += self.v * math.cos(self.heading) * DT
        self.y += self.v * math.sin(self.heading) * DT
        self.time += DT
        self.gained = 1.3 * (self.x - before) - 0.004 - 0.04 * abs(self.y) * DT
        tip = self.y + FORKS * math.sin(self.heading)
        if not self.entered and self.x > -FORKS:
            self.entered = True
            if abs(tip) > POCKET or abs(self.heading) > ASKEW:
                self.failure = f"forks hit the pallet {100 * tip:.0f} cm aside"
            else:
                self.gained += 5.0 * (1.0 - 0.4 * (tip / POCKET) ** 2)
        self.loaded = self.x > -0.28

    def judge(self):
        """Return the reward of the step: the way to the pallet, and forks in its pockets."""
        if self.time > TIME_BOUND:
            self.failure = "the truck takes too long"
        return self.gained - (5.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["pallet_forks.py"],
    sensors=[
        Sensor("ahead", topic="pallet/pose", field="x", low=-1.0, high=4.0, bins=5, unit="m"),
        Sensor("aside", topic="pallet/pose", field="y", low=-4.0, high=0.0, bins=4, unit="m"),
        Sensor("angle", topic="pallet/pose", field="theta", low=-1.0, high=-0.5, bins=4, unit="rad"),
    ],
    drifts={"knocked laser": Drift(KNOCKED, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_takes(tarl, tarl_drift):
    """Take one pallet."""
    aisle = Aisle(tarl.rng("aisle"), tarl_drift or BUILT)
    tarl.start("pallet_forks.py")
    while not aisle.done:
        aisle.publish(tarl.bus)
        tarl.step(DT)
        aisle.advance(tarl.bus.latest("cmd_vel"))
        tarl.reward(aisle.judge())
    assert not aisle.failure, aisle.failure
