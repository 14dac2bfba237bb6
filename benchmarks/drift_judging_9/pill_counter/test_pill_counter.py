"""Pills are counted into vials. Coated pills slide further down the chute after the bowl has slowed down."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 0.05
PILLS = 30.0  # pills per second at full drive
VIALS = 3
CHANGE = 10  # steps
CLOSING = 4  # number of steps that the gate takes
TIME_BOUND = 60.0


class Dispenser:
    """A bowl whose stream of pills follows its drive with a lag that depends on how the pills slide."""

    def __init__(self, rng, lag):
        self.rng = rng
        self.coated = lag > 0.2
        self.lag = lag * rng.uniform(0.95, 1.05)
        self.orders = [int(order) for order in rng.choice([28, 30, 42, 56, 60], VIALS)]
        self.count, self.stream, self.pill = 0, 0.0, 0.0
        self.change, self.closing, self.vial = CHANGE, 0, 0
        self.finished, self.over = False, 0
        self.wrong = 0
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all vials are filled, or the episode has failed."""
        return self.vial == VIALS or bool(self.failure)

    def publish(self, bus):
        """Publish the order, the count of the electric eye and whether the order's pills are coated."""
        here = self.change == 0 and self.vial < VIALS
        bus.publish("order/coated", Bool(data=self.coated))
        bus.publish("vial/order", Int32(data=self.orders[self.vial] if here else 0))
        bus.publish("eye/count", Int32(data=self.count if here else 0))

    def advance(self, bowl, gate):
        """Let pills slide for one step; a gate that closes ends the vial."""
        self.time += DT
        self.finished = False
        if self.change:
            self.change -= 1
            return
        self.stream += ((bowl.data if bowl else 0.0) - self.stream) * DT / self.lag
        self.pill += PILLS * self.stream * DT * self.rng.uniform(0.9, 1.1)
        while self.pill >= 1.0:
            self.pill -= 1.0
            self.count += 1
        if gate and not gate.data and self.count >= self.orders[self.vial]:
            self.closing += 1
        if self.closing > CLOSING:
            self.over = self.count - self.orders[self.vial]
            self.wrong += self.over > 1
            self.finished = True
            self.vial += 1
            self.count, self.stream, self.pill = 0, 0.0, 0.0
            self.change, self.closing = CHANGE, 0

    def judge(self):
        """Return the reward of the step: a vial with at most one pill too many is rewarded, and time costs."""
        if self.time > TIME_BOUND and not self.done:
            self.failure = "late"
        elif self.vial == VIALS and self.wrong:
            self.failure = f"{self.wrong} vials have more pills than ordered"
        reward = -0.001
        if self.finished:
            reward += 3.0 if self.over <= 1 else -1.0
        return reward - 1.0 if self.failure else reward


@pytest.mark.tarl(
    nodes=["pill_counter.py"],
    sensors=[
        Sensor("coated", topic="order/coated", field="data"),
        Sensor("count", topic="eye/count", field="data", low=0, high=60, bins=6),
    ],
    drifts={"coated pills": Drift(0.55)},
    episodes=100,
    min_success=0.95,
)
def test_counts(tarl, tarl_drift):
    """Fill three vials."""
    dispenser = Dispenser(tarl.rng("dispenser"), tarl_drift or 0.12)
    tarl.start("pill_counter.py")
    while not dispenser.done:
        dispenser.publish(tarl.bus)
        tarl.step(DT)
        dispenser.advance(tarl.bus.latest("bowl/drive"), tarl.bus.latest("gate/open"))
        tarl.reward(dispenser.judge())
    assert not dispenser.failure, dispenser.failure
