"""Euros are taken and foreign coins returned. New foreign coins give the readings of 2 euros in every sensor."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.2
COINS = 24
EUROS = {50: (24.25, 410.0, 78.0), 100: (23.25, 265.0, 75.0), 200: (25.75, 318.0, 85.0)}
FOREIGN = (26.0, 230.0, 85.0)  # the known foreign coin, whose core is another alloy
NOISE = (0.1, 4.0, 1.5)
WRONG = 2  # maximum number of coins judged wrongly in a mission


class Slot:
    """A handful of coins; with `alike`, the foreign coins give the readings of 2 euros."""

    def __init__(self, rng, alike):
        self.rng = rng
        self.foreign = EUROS[200] if alike else FOREIGN
        self.coins = [int(rng.choice([50, 100, 200, 200])) for _ in range(COINS)]
        self.coins = [0 if cents == 200 and rng.random() < 0.5 else cents for cents in self.coins]
        # four coins of each kind
        self.coins[:8] = [int(cents) for cents in rng.permutation([200] * 4 + [0] * 4)]
        self.credit, self.rolled = 0, 0
        self.wrong = 0

    @property
    def done(self):
        """Return whether the last coin has been judged."""
        return self.rolled >= COINS

    def publish(self, bus):
        """Let one coin roll past barrier, coil and piezo."""
        cents = self.coins[self.rolled]
        shape = EUROS.get(cents, self.foreign)
        readings = [value + self.rng.normal(0.0, noise) for value, noise in zip(shape, NOISE, strict=True)]
        for what, reading in zip(("diameter", "damping", "thud"), readings, strict=True):
            bus.publish(f"coin/{what}", Float32(data=reading))

    def judge(self, accept, credit):
        """Return the reward of a coin: a foreign coin that is taken costs as much as a euro that is returned."""
        cents = self.coins[self.rolled]
        self.rolled += 1
        paid = (credit.data if credit else 0) - self.credit
        self.credit += paid
        taken = bool(accept and accept.data)
        right = taken == (cents > 0) and paid == cents
        self.wrong += not right
        return 10.0 / COINS if right else -15.0 / COINS


@pytest.mark.tarl(
    nodes=["acceptor.py"],
    sensors=[
        Sensor("diameter", topic="coin/diameter", field="data", low=22, high=27, bins=5, unit="mm"),
        Sensor("damping", topic="coin/damping", field="data", low=200, high=440, bins=8),
        Sensor("thud", topic="coin/thud", field="data", low=70, high=90, bins=3),
    ],
    drifts={"foreign coins": True},
    episodes=100,
    min_success=0.95,
)
def test_takes_euros(tarl, tarl_drift):
    """Pay with a handful of coins."""
    slot = Slot(tarl.rng("slot"), tarl_drift or False)
    tarl.start("acceptor.py")
    while not slot.done:
        slot.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(slot.judge(tarl.bus.latest("flap/accept"), tarl.bus.latest("till/credit")))
    assert slot.wrong <= WRONG, f"{slot.wrong} coins were judged wrongly"
