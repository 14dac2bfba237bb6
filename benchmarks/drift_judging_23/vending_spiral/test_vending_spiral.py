"""A vending machine sells bags of crisps. The new bags are puffier, for good, and hang on the spiral at times."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Int32 = message_type("std_msgs/Int32")

DT = 0.1
FLAT = {"often": 0.06, "hang": 0.1}
PUFFY = {"often": 0.07, "hang": 0.52}  # share of the bags that hang; turns by which they fall late


class Machine:
    """A machine in which some bags fall later than others: by `hang` turns of the spiral."""

    def __init__(self, rng, often, hang):
        self.rng = rng
        self.falls = []
        for bag in range(12):
            late = max(0.02, rng.normal(hang, 0.04)) if rng.random() < often else -abs(rng.normal(0.04, 0.03))
            self.falls.append(bag + 1.0 + late)
        self.angle, self.fallen, self.falling = 0.0, 0, []
        self.ordered, self.sold, self.next = 0, 0, 0.5
        self.results = []
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether all customers were served, or one has to call the hotline."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the home switch, the curtain, and the customers' orders."""
        turned = self.angle % 1.0
        bus.publish("spiral/home", Bool(data=turned < 0.06 or turned > 0.98))
        bus.publish("chute/curtain", Bool(data=any(at <= self.time < at + DT for at in self.falling)))
        if self.next is not None and self.time >= self.next:
            self.next = None
            self.ordered += 1
            bus.publish("vend/order", Int32(data=12))

    def advance(self, speed):
        """Turn the spiral for one step."""
        self.time += DT
        self.gained = -0.005
        self.angle += DT * (speed.data if speed else 0.0) * self.rng.normal(1.0, 0.02)
        while self.falls[self.fallen] < self.angle:
            self.fallen += 1
            self.falling.append(self.time + 0.35 + abs(self.rng.normal(0.0, 0.05)))
        for result in self.results:
            if result == "sold":
                self.sold += 1
                self.gained += 1.0
                self.next = self.time + 1.0
            else:
                self.failure = f"customer calls the hotline: {result}"
        self.results.clear()
        if self.fallen > self.ordered:
            self.failure = "two bags fall for one coin"
        elif self.time > 60.0:
            self.failure = "customers leave"
        self.over = self.sold == 8
        if self.failure:
            self.gained -= 3.0


@pytest.mark.tarl(
    nodes=["vending_spiral.py"],
    sensors=[
        Sensor("home", topic="spiral/home", field="data"),
        Sensor("curtain", topic="chute/curtain", field="data"),
    ],
    drifts={"puffy": Drift(PUFFY, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_sells(tarl, tarl_drift):
    """Serve eight customers."""
    machine = Machine(tarl.rng("machine"), **(tarl_drift or FLAT))
    tarl.start("vending_spiral.py")
    tarl.bus.subscribe("vend/result", lambda message: machine.results.append(message.data))
    while not machine.done:
        machine.publish(tarl.bus)
        tarl.step(DT)
        machine.advance(tarl.bus.latest("spiral/speed"))
        tarl.reward(machine.gained)
    assert not machine.failure, machine.failure
