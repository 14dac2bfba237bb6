"""Tubs get the ordered weight. The new tubs of the supplier are permanently heavier."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")

DT = 0.1
TUBS = 3
FLOW = 45.0  # flow through an open flap (g/s)
WRONG = 8.0  # g
TIME_BOUND = 30.0


class Counter:
    """A scale with a sequence of tubs of `weight` g."""

    def __init__(self, rng, weight):
        self.rng = rng
        self.tubs = [weight + rng.uniform(-1.0, 1.0) for _ in range(TUBS)]
        self.orders = [rng.uniform(80.0, 180.0) for _ in range(TUBS)]
        self.at, self.ice, self.falling, self.pause, self.still = 0, 0.0, 0.0, 5, 0
        self.wrong = None
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all tubs have been taken, or the episode has failed."""
        return self.at == TUBS or bool(self.failure)

    def publish(self, bus):
        """Publish order and scale."""
        gross = self.tubs[self.at] + self.ice if self.pause == 0 else 0.0
        bus.publish("/order", Float32(data=self.orders[self.at]))
        bus.publish("/scale", Float32(data=gross + self.rng.normal(0.0, 0.3)))

    def advance(self, flap, ready):
        """Let ice fall for one step; a tub is taken half a second after it is ready."""
        self.wrong = None
        self.time += DT
        if self.pause:
            self.pause -= 1
            return
        self.ice += self.falling
        self.falling = FLOW * max(0.0, min(1.0, flap.data)) * DT if flap else 0.0
        self.still = self.still + 1 if ready and ready.data else 0
        if self.still >= 5:
            self.wrong = abs(self.ice - self.orders[self.at])
            self.at, self.ice, self.falling, self.pause, self.still = self.at + 1, 0.0, 0.0, 8, 0

    def judge(self):
        """Return the reward of the step, for each tub that is taken."""
        if self.time > TIME_BOUND:
            self.failure = "late"
        elif self.wrong is not None and self.wrong > WRONG:
            self.failure = f"a tub is wrong by {self.wrong:.0f} g"
        if self.failure:
            return -4.0
        return 0.0 if self.wrong is None else 10.0 / TUBS - 0.1 * self.wrong


@pytest.mark.tarl(
    nodes=["portion.py"],
    sensors=[
        Sensor("gross", topic="/scale", field="data", low=0, high=240, bins=8, unit="g"),
        Sensor("order", topic="/order", field="data", low=80, high=180, bins=2, unit="g"),
    ],
    drifts={"heavier tubs": Drift(61.0, permanent=True)},
    episodes=100,
    min_success=0.95,
)
def test_fills_tubs(tarl, tarl_drift):
    """Fill three tubs."""
    counter = Counter(tarl.rng("counter"), tarl_drift or 38.0)
    tarl.start("portion.py")
    while not counter.done:
        counter.publish(tarl.bus)
        tarl.step(DT)
        counter.advance(tarl.bus.latest("/flap"), tarl.bus.latest("/ready"))
        tarl.reward(counter.judge())
    assert not counter.failure, counter.failure
