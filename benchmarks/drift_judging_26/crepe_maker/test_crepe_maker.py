"""A robot makes crepes at a market. In the wind its gas plate reaches only 178 degrees, and the batter sets slowly.

A crepe earns, less the further it is from golden, seconds cost a little, and a torn or burnt crepe ends the shift.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Int32 = message_type("std_msgs/Int32")

DT = 1.0
CALM = {"plate": 215.0}
WINDY = {"plate": 178.0}  # deg C
LASTS = {"pour": 3, "spread": 6, "flip": 3, "serve": 4}  # s
ORDERS = 2


class Stall:
    """A stall whose plate has some temperature."""

    def __init__(self, rng, plate):
        self.rng = rng
        self.goal = plate + rng.normal(0.0, 2.0)
        self.temperature = self.goal - 5.0
        self.batter = 0.9
        self.sides = None  # doneness of the lower and the upper side
        self.lower = 0
        self.actions, self.action, self.left = [], "", 0
        self.served = 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether the shift is over."""
        return bool(self.failure) or self.served >= ORDERS

    def publish(self, bus):
        """Publish the plate, the arm, the batter and the orders."""
        bus.publish("plate/temperature", Float32(data=self.temperature + self.rng.normal(0.0, 1.0)))
        bus.publish("arm/busy", Bool(data=self.left > 0))
        if round(self.time / DT) % 5 == 0:
            bus.publish("batter/level", Float32(data=self.batter))
            bus.publish("till/orders", Int32(data=ORDERS))

    def finish(self, action):
        """Complete an action of the arm."""
        if action == "spread":
            self.batter -= 0.08
            self.sides = [0.0, 0.0]
            self.lower = 0
            self.temperature -= 6.0
        elif action == "flip" and self.sides:
            if self.sides[0] < 0.9:
                self.failure = "crepe tears"
            self.lower = 1
        elif action == "serve" and self.sides:
            first, second = self.sides
            self.gained += 3.6 - 0.5 * abs(first - 1.1) - 0.5 * abs(second - 0.66)
            self.served += 1
            self.sides = None
            if second < 0.5:
                self.failure = "crepe is raw"

    def advance(self):
        """Let one step pass."""
        self.time += DT
        self.gained = -0.0008
        self.temperature += DT / 12.0 * (self.goal - self.temperature) + self.rng.normal(0.0, 0.3)
        if self.sides:
            self.sides[self.lower] += DT * max(0.0, self.temperature - 120.0) / 95.0 / 40.0
            if max(self.sides) > 1.45:
                self.failure = "crepe burns"
        if self.left > 0:
            self.left -= 1
            if self.left == 0:
                self.finish(self.action)
        elif self.actions:
            self.action = self.actions.pop(0)
            self.left = LASTS[self.action]
        if self.time > 600.0:
            self.failure = "market closes"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["crepe_maker.py"],
    sensors=[
        Sensor(
            "plate", topic="plate/temperature", field="data", low=140.0, high=240.0, bins=10, unit="deg C"
        ),
        Sensor("batter", topic="batter/level", field="data", low=0.0, high=1.0, bins=4, unit="l"),
    ],
    drifts={"windy": WINDY},
    episodes=200,
    min_success=0.97,
)
def test_serves(tarl, tarl_drift):
    """Serve two crepes: up to 3.6 for each, a small cost per second, -4 for a spoilt one."""
    stall = Stall(tarl.rng("stall"), **(tarl_drift or CALM))
    tarl.start("crepe_maker.py")
    tarl.bus.subscribe("arm/action", lambda message: stall.actions.append(message.data))
    while not stall.done:
        stall.publish(tarl.bus)
        tarl.step(DT)
        stall.advance()
        tarl.reward(stall.gained)
    assert not stall.failure, stall.failure
