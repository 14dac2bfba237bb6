"""A baggage tug stops in front of a belt loader. For a charter flight it pulls six dollies, none with a brake."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Range = message_type("sensor_msgs/msg/Range")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.1
LINE = {"dollies": 2}
CHARTER = {"dollies": 6}


class Apron:
    """A tug with `dollies` behind it."""

    def __init__(self, rng, dollies):
        self.rng = rng
        self.dollies = dollies
        self.mass = 3.0 + dollies * float(rng.uniform(0.85, 1.15))  # t
        self.grip = 6.0 * rng.normal(1.0, 0.03)  # kN at which the wheels of the tug slip
        self.gap, self.speed = float(rng.uniform(14.0, 17.0)), 2.8
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the tug is parked, or the turnaround is lost."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the range, and every second what is behind and around the tug."""
        bus.publish("loader/range", Range(range=max(0.05, self.gap + self.rng.normal(0.0, 0.012))))
        if round(self.time / DT) % 10 == 0:
            bus.publish("train/dollies", UInt8(data=self.dollies))
            bus.publish("lidar/person", Bool(data=False))

    def advance(self, twist, state):
        """Drive for one step."""
        self.time += DT
        self.gained = -0.06
        wish = twist.linear.x if twist else 0.0
        pull = max(-self.grip / self.mass, min(3.5 / self.mass, 4.0 * (wish - self.speed)))
        self.speed = max(0.0, self.speed + DT * pull)
        self.gap -= DT * self.speed
        if self.gap < 0.35:
            self.failure = "tug runs into the loader"
        elif self.time > 13.0:
            self.failure = "the bags come too late"
        elif state and state.data == "parked" and self.speed < 0.02:
            off = abs(self.gap - 0.85)
            self.over = True
            self.gained += 8.0 - 4.0 * off
            if off > 0.3:
                self.failure = "the loader does not reach the bags"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["luggage_tug.py", "approach.py"],
    sensors=[
        Sensor("dollies", topic="train/dollies", field="data", low=0.0, high=8.0, bins=8),
        Sensor("gap", topic="loader/range", field="range", low=0.0, high=14.0, bins=7, unit="m"),
    ],
    drifts={"charter": CHARTER},
    episodes=200,
    min_success=0.97,
)
def test_parks(tarl, tarl_drift):
    """Drive to one loader."""
    apron = Apron(tarl.rng("apron"), **(tarl_drift or LINE))
    tarl.start("luggage_tug.py")
    while not apron.done:
        apron.publish(tarl.bus)
        tarl.step(DT)
        apron.advance(tarl.bus.latest("cmd_vel"), tarl.bus.latest("tug/state"))
        tarl.reward(apron.gained)
    assert not apron.failure, apron.failure
