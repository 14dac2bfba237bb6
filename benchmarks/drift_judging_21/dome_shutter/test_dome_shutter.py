"""The shutter of an observatory. Its battery is old, the motor turns slower, and the shutter stops on its way."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
String = message_type("std_msgs/String")

DT = 1.0
FRESH = {"volts": 12.6, "ohms": 0.08}
OLD = {"volts": 12.1, "ohms": 0.36}  # at rest, of the inner resistance


class Dome:
    """A shutter with a motor that draws 7 A from a battery of `volts` and `ohms`."""

    def __init__(self, rng, volts, ohms):
        self.rng = rng
        self.volts = (volts - 7.0 * ohms) * rng.normal(1.0, 0.008)
        self.rate = 0.0475 / 12.0 * rng.normal(1.0, 0.012)  # of the slit per s and volt
        self.slit, self.slips = 0.0, 0
        self.close_at = int(rng.integers(45, 60))
        self.time, self.gained, self.failure, self.over, self.images = 0, 0.0, "", False, 0

    @property
    def done(self):
        """Return whether the night is over, or lost."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the weather and the wishes of the astronomer."""
        bus.publish("weather/wind", Float32(data=max(0.0, self.rng.normal(3.0, 0.8))))
        if self.time % 5 == 0:
            bus.publish("weather/rain", Bool(data=False))
        if self.time in (2, self.close_at):
            bus.publish("shutter/command", String(data="open" if self.time == 2 else "close"))

    def advance(self, motor, status):
        """Run for one step; whether the night was good shows in the morning only."""
        self.time += DT
        self.gained = 0.0
        way = motor.data if motor else 0
        travel = DT * way * self.volts * self.rate
        if not 0.0 <= self.slit + travel <= 1.0:
            self.slips += 1
        self.slit = min(1.0, max(0.0, self.slit + travel))
        said = status.data if status else "closed"
        if said == "open":
            self.images += self.slit > 0.975
        if self.slips > 45:
            self.failure = "the clutch is worn"
        elif self.time > 130:
            self.failure = "the shutter is open at dawn"
        elif said == "closed" and self.time > self.close_at:
            self.over = True
            if self.slit > 0.02:
                self.failure = "the slit is open at dawn"
            elif self.images < 8:
                self.failure = "the shutter is in the images"
            else:
                self.gained = 10.0 - 0.01 * self.slips


@pytest.mark.tarl(
    nodes=["dome_shutter.py"],
    sensors=[
        Sensor("wind", topic="weather/wind", field="data", low=0.0, high=8.0, bins=4, unit="m/s"),
        Sensor("motor", topic="shutter/motor", field="data", low=-1.0, high=1.0, bins=3),
    ],
    drifts={"old": OLD},
    episodes=200,
    min_success=0.97,
)
def test_opens_and_closes(tarl, tarl_drift):
    """Open in the evening, and close before dawn."""
    dome = Dome(tarl.rng("dome"), **(tarl_drift or FRESH))
    tarl.start("dome_shutter.py")
    while not dome.done:
        dome.publish(tarl.bus)
        tarl.step(DT)
        dome.advance(tarl.bus.latest("shutter/motor"), tarl.bus.latest("shutter/status"))
        tarl.reward(dome.gained)
    assert not dome.failure, dome.failure
