"""A bag is released with the ordered weight. Damp powder packs badly: a turn moves less powder."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/Float64")

DT = 0.1
PER_TURN = 0.04  # mass of dry powder (kg)
MARGIN = 0.25  # share of the order by which a bag may be wrong
TIME_BOUND = 22.0


class Hopper:
    """A screw below a hopper; `packing` is the powder moved per turn, as a share of that of dry powder."""

    def __init__(self, rng, packing):
        self.rng = rng
        self.packing = packing
        self.damp = 40.0 + 100.0 * (1.0 - packing) + rng.uniform(-5.0, 5.0)
        self.order = rng.uniform(1.5, 4.0)
        self.turns = rng.uniform(0.0, 900.0)
        self.speed, self.weight = 0.0, 0.0
        self.time = 0.0
        self.released = False
        self.failure = ""

    def publish(self, bus):
        """Publish the order, the encoder count and the moisture."""
        bus.publish("/order", Float64(data=self.order))
        bus.publish("/moisture", Float64(data=self.damp + self.rng.normal(0.0, 0.5)))
        bus.publish("/turns", Float64(data=self.turns))

    def advance(self, screw, release):
        """Turn for one step."""
        wanted = max(0.0, min(15.0, screw.data)) if screw else 0.0
        self.speed += (wanted - self.speed) * 0.7
        turned = self.speed * DT
        self.turns += turned
        self.weight += turned * PER_TURN * self.packing * (1.0 + self.rng.normal(0.0, 0.05))
        self.time += DT
        self.released = bool(release and release.data)

    def judge(self):
        """Return the reward of the step: time costs, the right weight is rewarded."""
        wrong = abs(self.weight / self.order - 1.0)
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.released and wrong > MARGIN:
            self.failure = f"{self.weight:.2f} kg instead of {self.order:.2f} kg"
        if self.failure:
            return -5.0
        return 10.0 - 2.0 * wrong if self.released else -0.005


@pytest.mark.tarl(
    nodes=["doser.py"],
    sensors=[
        Sensor("moisture", topic="/moisture", field="data", low=30, high=90, bins=12, unit="%"),
        Sensor("order", topic="/order", field="data", low=1.5, high=4, bins=5, unit="kg"),
    ],
    drifts={"damp powder": Drift.range(0.58, 0.74)},
    episodes=100,
    min_success=0.95,
)
def test_fills_the_bag(tarl, tarl_drift):
    """Fill one bag."""
    hopper = Hopper(tarl.rng("hopper"), tarl_drift or 1.0)
    tarl.start("doser.py")
    while not (hopper.released or hopper.failure):
        hopper.publish(tarl.bus)
        tarl.step(DT)
        hopper.advance(tarl.bus.latest("/screw"), tarl.bus.latest("/release"))
        tarl.reward(hopper.judge())
    assert not hopper.failure, hopper.failure
