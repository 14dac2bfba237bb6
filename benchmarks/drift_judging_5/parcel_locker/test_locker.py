"""A parcel locker pulls a latch for a short time. In winter about one latch in nine is stiff and needs longer."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 0.1
CODES = {"7031": 1, "4410": 2, "9256": 3, "1188": 4}
COIL = 1.4  # time for which the coil tolerates uninterrupted current (s)
TIME_BOUND = 12.0


class Cabinet:
    """A cabinet in which a share of the latches is stiff."""

    def __init__(self, rng, stiff):
        self.rng = rng
        self.code = str(rng.choice(list(CODES)))
        self.needs = rng.uniform(0.1, 0.18)
        if rng.random() < stiff:
            self.needs = rng.uniform(0.42, 0.56)
        self.swing = rng.uniform(0.2, 0.6)  # time from latch to switch (s)
        self.current = 0.0
        self.free = None
        self.taken = False
        self.time = 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether the customer has left, or the episode has failed."""
        return self.taken or bool(self.failure)

    @property
    def open(self):
        """Return whether the door's switch is released."""
        return self.free is not None and self.time - self.free > self.swing

    def publish(self, bus):
        """Publish the customer's code and the switch."""
        bus.publish("keypad/code", String(data=self.code))
        bus.publish("door/open", Bool(data=self.open))

    def advance(self, voltage, door, text):
        """Pull the latch for one step; return the reward."""
        on = voltage is not None and voltage.data > 9.0
        self.current = self.current + DT if on else 0.0
        if on and self.current >= self.needs and door and door.data == CODES[self.code]:
            self.free = self.time if self.free is None else self.free
        self.time += DT
        if self.current > COIL:
            self.failure = "the coil is burnt"
        elif text and text.data == "please call us":
            self.failure = "the customer calls"
        elif self.time > TIME_BOUND:
            self.failure = "the customer is gone"
        self.taken = bool(text and text.data.startswith("please take") and self.open)
        if self.failure:
            return -10.0
        return 10.0 if self.taken else -0.01 - (0.02 if on else 0.0)


@pytest.mark.tarl(
    nodes=["locker.py"],
    sensors=[Sensor("open", topic="door/open", field="data", low=0, high=1, bins=2)],
    drifts={"winter": 0.11},
    episodes=200,
    min_success=0.95,
)
def test_serves(tarl, tarl_drift):
    """Serve one customer."""
    cabinet = Cabinet(tarl.rng("cabinet"), tarl_drift or 0.0)
    tarl.start("locker.py")
    while not cabinet.done:
        cabinet.publish(tarl.bus)
        tarl.step(DT)
        topics = ("latch/voltage", "latch/door", "screen/text")
        tarl.reward(cabinet.advance(*(tarl.bus.latest(topic) for topic in topics)))
    assert not cabinet.failure, cabinet.failure
